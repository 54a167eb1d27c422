#include <algorithm>
#include <cmath>

#include "apps/figures/svg_chart.h"
#include "apps/report/report_page.h"
#include "apps/results/calibration_output.h"
#include "core/util/format.h"
#include "frontend/calibration/calibration_verdict.h"

namespace rgbd_pose {
namespace {

using Status = CalibratedParameter::Status;

constexpr char kHead[] =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
    "<title>Calibration</title><style>"
    "body{font-family:sans-serif;max-width:60em;margin:2em auto;color:#222}"
    "table{border-collapse:collapse}td,th{padding:.2em .8em;text-align:right;"
    "border-bottom:1px solid #ddd}td:first-child,th:first-child{text-align:"
    "left}figure{display:inline-block;margin:0 1em 1em 0}svg{background:#f7f7"
    "f7;border:1px solid #ccc}.no{color:#888}</style></head><body>\n";

// Draws the start value and the value found, from -1 to 1 prior standard
// deviation; an arrow marks a value outside of this range.
std::string Bar(const CalibratedParameter& parameter) {
  constexpr double kHalf = 80.0;
  const auto sigmas = [&](double value) {
    return (value - parameter.before) / parameter.prior;
  };
  const double found = sigmas(parameter.found);
  if (std::abs(found) > 1.0) {
    return Format("<b style=\"color:#d62728\">%s %+.1f sigma</b>",
                  found > 0.0 ? "&rarr;" : "&larr;", found);
  }
  const std::string text = Format(
      "<svg width=\"%.0f\" height=\"14\"><line x1=\"%.0f\" x2=\"%.0f\" "
      "y1=\"0\" y2=\"14\" stroke=\"#aaa\"/>",
      2.0 * kHalf, kHalf, kHalf);
  const auto at = [&](double value) {
    return kHalf * (1.0 + std::clamp(sigmas(value), -1.0, 1.0));
  };
  const double low = at(parameter.found - parameter.sigma);
  const double high = at(parameter.found + parameter.sigma);
  return text + Format(
                    "<rect x=\"%.1f\" y=\"4\" width=\"%.1f\" height=\"6\" "
                    "fill=\"#1f77b4\"/></svg>",
                    low, std::max(1.5, high - low));
}

std::string ParameterTable(const CalibrationResult& result) {
  std::string text =
      "<table><tr><th>parameter</th><th>before</th><th>found</th>"
      "<th>&plusmn;</th><th></th><th>change, -1 to 1 prior sigma</th></tr>\n";
  for (int k = 0; k < kCalibrationSize; ++k) {
    const CalibrationParameter& row = kCalibrationParameters[k];
    const CalibratedParameter& parameter = result.parameters[k];
    if (parameter.status == Status::kDetermined) {
      text += Format(
          "<tr><td>%s</td><td>%s</td><td>%s</td><td>%s</td>"
          "<td>%s</td><td>%s</td></tr>\n",
          row.what, ShortNumber(parameter.before).c_str(),
          NumberTo(parameter.found, parameter.sigma).c_str(),
          NumberTo(parameter.sigma, parameter.sigma).c_str(), row.unit,
          Bar(parameter).c_str());
    } else {
      text += Format(
          "<tr class=\"no\"><td>%s</td><td>%.6g</td><td "
          "colspan=\"2\">%s</td><td>%s</td><td></td></tr>\n",
          row.what, parameter.before, ToString(parameter.status), row.unit);
    }
  }
  return text + "</table>\n";
}

// After a camera was rejected.
constexpr char kWhatNext[] =
    "<p>What to do next:</p><ul>"
    "<li>&ldquo;fit no better&rdquo; or &ldquo;no error found&rdquo;: the "
    "first camera is as good; continue to use it.</li>"
    "<li>&ldquo;halves of the recording disagree&rdquo;: there is an error "
    "that no parameter describes: blur, moving objects, a wrong depth unit, "
    "a lens of another kind.</li>"
    "<li>&ldquo;not plausible&rdquo; or an arrow in the table: the parameter "
    "compensates for another error; keep it with --fix=.</li>"
    "<li>too few pairs, or no parameter determined: record half a minute, turn "
    "and move at the same time, with near and far objects in view.</li></ul>\n";

std::string PathPicture(const Trajectory& path) {
  ChartSeries line{"camera", {"#0072B2", "", -1}};
  for (const StampedPose& pose : path) {
    const Eigen::Vector3d& p = pose.world_from_cam.translation;
    line.points.push_back({p.x(), p.z()});
  }
  ChartPanel panel{
      "Path from above, as tracked in the last pass", "x, m", "z, m", {line}};
  panel.is_map = true;
  return FormatSvg({"", {panel}});
}

}  // namespace

std::string CalibrationPage(const CalibrationResult& result,
                            const Trajectory& path) {
  std::string text = kHead;
  text += result.is_accepted ? "<h1>The new camera is better</h1>\n"
                             : "<h1>The first camera is kept</h1>\n<p>" +
                                   EscapeMarkup(result.reason) + "</p>\n";
  text +=
      Format("<p>%d keyframes, %d pairs, %d landmarks in %d views.</p>\n",
             result.keyframes, result.pairs, result.landmarks, result.views);
  if (!result.is_accepted) text += kWhatNext;
  if (result.noise.has_value()) {
    text += Format(
        "<p>Depth scatters by %.3g times the sigma that was assumed%s.</p>\n",
        result.noise->in_old_sigmas,
        result.noise->IsPlausible()
            ? ""
            : ": <b>too large for sensor noise</b>; depth is displaced, so do "
              "not use depth_noise.yaml");
  }
  text += ParameterTable(result);
  text +=
      result.scale_from.empty()
          ? "<p>The depth scale is unchanged: images do not contain it; give "
            "a known length, ground truth or motion guess.</p>\n"
          : "<p>Depth scale estimated from " + result.scale_from + ".</p>\n";
  if (result.held_out_pairs > 0) {
    const double change =
        100.0 * (result.cost_after / result.cost_before - 1.0);
    text += Format(
        "<h2>Held-out pairs</h2><p>%d pairs: the cost per view %s by %.2g %%, "
        "from %.4g to %.4g (%.1f standard deviations of the difference).</p>\n",
        result.held_out_pairs, change > 0.0 ? "rises" : "falls",
        std::abs(change), result.cost_before, result.cost_after,
        std::abs(result.gain_sigmas));
    text += "<p>Check: " + HalvesInWords(result) + ".</p>\n";
    text += ResidualPictures(result);
  }
  return text + PathPicture(path) + "</body></html>\n";
}

}  // namespace rgbd_pose
