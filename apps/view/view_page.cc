#include "apps/view/view_page.h"

#include "apps/report/report_assets.h"
#include "apps/report/report_page.h"

namespace rgbd_pose {

std::string ViewPage(const std::string& title) {
  const ReportAssets assets = EmbeddedReportAssets();
  return FillPage(assets.view_page,
                  {{"%STYLE%", std::string(assets.view_style)},
                   {"%DATA%", InlineData({{"title", title}})},
                   {"%SCRIPT%", std::string(assets.view_script)}});
}

}  // namespace rgbd_pose
