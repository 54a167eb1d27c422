#include <cmath>
#include <nlohmann/json.hpp>

#include "apps/report/report_page.h"
#include "apps/results/calibration_output.h"
#include "core/util/format.h"
#include "frontend/calibration/calibration_verdict.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;

// Rounds a number, so that the page stays small.
json Rounded(double value, double step) {
  return std::isfinite(value) ? json(step * std::round(value / step)) : json();
}

// [u, v, du, dv before, du, dv after, motion u, v] of each held-out view (px,
// px/s). Wrong matches would dominate the pictures and are left out.
json Residuals(const CalibrationResult& result) {
  constexpr double kMostPx = 20.0;
  json rows = json::array();
  for (const HeldOutResidual& r : result.residuals) {
    if (!(r.before.norm() < kMostPx && r.after.norm() < kMostPx)) continue;
    rows.push_back({Rounded(r.u, 1.0), Rounded(r.v, 1.0),
                    Rounded(r.before.x(), 1e-3), Rounded(r.before.y(), 1e-3),
                    Rounded(r.after.x(), 1e-3), Rounded(r.after.y(), 1e-3),
                    Rounded(r.flow.x(), 0.1), Rounded(r.flow.y(), 0.1)});
  }
  return rows;
}

// The texts that the page has in common with the summary.
json WordsOf(const CalibrationResult& result) {
  json rows = json::array();
  for (const CalibratedParameter& parameter : result.parameters) {
    rows.push_back({ShortNumber(parameter.before),
                    NumberTo(parameter.found, parameter.sigma),
                    NumberTo(parameter.sigma, parameter.sigma)});
  }
  return {{"parameters", rows},
          {"left", WhatIsLeft(result)},
          {"halves", HalvesInWords(result)},
          {"unseen", UnseenInWords(result)}};
}

}  // namespace

std::string CalibrationPage(const CalibrationResult& result,
                            const Trajectory& path) {
  json places = {{"x", json::array()}, {"z", json::array()}};
  for (const StampedPose& pose : path) {
    const Eigen::Vector3d& p = pose.world_from_cam.translation;
    places["x"].push_back(Rounded(p.x(), 1e-4));
    places["z"].push_back(Rounded(p.z(), 1e-4));
  }
  const bool is_noise = !result.noise || result.noise->IsPlausible();
  return ReportPage("calibration", {{"calibration", CalibrationToJson(result)},
                                    {"noise_is_plausible", is_noise},
                                    {"words", WordsOf(result)},
                                    {"width", result.camera.camera.width},
                                    {"height", result.camera.camera.height},
                                    {"residuals", Residuals(result)},
                                    {"path", places}});
}

}  // namespace rgbd_pose
