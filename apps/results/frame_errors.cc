#include "apps/results/frame_errors.h"

#include <cmath>
#include <optional>

#include "core/evaluation/pose_pairs.h"
#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

void AddNumber(double value, std::string* row) {
  *row += Format(",%.6f", value);
}

void AddPosition(const Eigen::Vector3d& position, std::string* row) {
  for (const double value : position) AddNumber(value, row);
}

}  // namespace

std::string FormatErrorsCsv(const std::vector<TrackedFrame>& frames,
                            const Trajectory& truth,
                            const EvaluationReport& report) {
  std::string text =
      "timestamp,true_x,true_y,true_z,x,y,z,position_error_m,rpe_m,rpe_deg\n";
  std::vector<double> times;
  times.reserve(truth.size());
  for (const StampedPose& pose : truth) times.push_back(pose.timestamp);
  auto error = report.poses.begin();
  for (const TrackedFrame& frame : frames) {
    text += Format("%.6f", frame.timestamp);
    const size_t nearest = NearestTime(times, frame.timestamp);
    if (std::abs(times[nearest] - frame.timestamp) <=
        report.options.max_time_difference) {
      AddPosition(truth[nearest].world_from_cam.translation, &text);
    } else {
      text += ",,,";
    }
    if (frame.status == TrackingStatus::kLost) {
      text += ",,,,,,\n";
      continue;
    }
    AddPosition(report.truth_from_estimate * frame.world_from_cam.translation,
                &text);
    if (error == report.poses.end() || error->timestamp != frame.timestamp) {
      text += ",,,\n";
      continue;
    }
    AddNumber(error->position, &text);
    if (error->rpe_translation.has_value()) {
      AddNumber(*error->rpe_translation, &text);
      AddNumber(*error->rpe_rotation * kDegreesPerRadian, &text);
    } else {
      text += ",,";
    }
    text += "\n";
    ++error;
  }
  return text;
}

}  // namespace rgbd_pose
