#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>
#include <vector>

#include "frontend/features/frontend.h"
#include "frontend/features/point_frontend.h"

namespace rgbd_pose {
namespace {

const cv::Size kWindow(15, 15);
constexpr int kMaxLevel = 3;  // coarsest pyramid level: 80 x 60 for 640 x 480
const cv::TermCriteria kTermination(cv::TermCriteria::COUNT +
                                        cv::TermCriteria::EPS,
                                    10, 0.03);

// A larger mean grey difference over the window means another place.
constexpr float kMaxMeanDifference = 25.0F;

struct KltPyramid {
  KltPyramid(const PreparedFrame& frame, bool with_derivatives) {
    cv::buildOpticalFlowPyramid(frame.gray, levels, kWindow, kMaxLevel,
                                with_derivatives);
  }
  std::vector<cv::Mat> levels;
};

class KltFrontend final : public PointFrontend {
 public:
  using PointFrontend::PointFrontend;

  void Prepare(const PreparedFrame& frame) const override {
    frame.Derived<KltPyramid>(/*with_derivatives=*/false);
  }

 private:
  void Follow(const PreparedFrame& from, const Points& points,
              const PreparedFrame& to, Points* moved, Found* found) override {
    std::vector<float> error;
    cv::calcOpticalFlowPyrLK(
        from.Derived<KltPyramid>(/*with_derivatives=*/true).levels,
        to.Derived<KltPyramid>(/*with_derivatives=*/false).levels, points,
        *moved, *found, error, kWindow, kMaxLevel, kTermination,
        cv::OPTFLOW_USE_INITIAL_FLOW);
    for (size_t i = 0; i < found->size(); ++i) {
      if (error[i] > kMaxMeanDifference) (*found)[i] = 0;
    }
  }
};

}  // namespace

std::unique_ptr<Frontend> MakeKltFrontend(const FrontendOptions& options) {
  return std::make_unique<KltFrontend>(options);
}

}  // namespace rgbd_pose
