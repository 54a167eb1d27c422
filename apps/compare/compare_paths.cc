#include <cmath>

#include "apps/compare/compare_sequence.h"
#include "apps/figures/svg_chart.h"
#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

// The truth at the times of all frames, where it has a pose close in time:
// nowhere if it is empty.
ComparedPath TruthAt(const std::vector<TrackedFrame>& frames,
                     const Trajectory& truth) {
  const std::vector<double> times = TimesOf(truth);
  ComparedPath path = {kTruthName, {}};
  for (const TrackedFrame& frame : frames) {
    ComparedPose& pose = path.poses.emplace_back();
    pose.timestamp = frame.timestamp;
    if (truth.empty()) continue;
    const size_t nearest = NearestTime(times, frame.timestamp);
    if (std::abs(times[nearest] - frame.timestamp) <=
        EvaluationOptions().max_time_difference) {
      pose.world_from_cam = truth[nearest].world_from_cam;
    }
  }
  return path;
}

// The motion that aligns a run with the truth at their first common pose.
Rigid3d WorldFromRun(const LossRun& run, const ComparedPath& truth) {
  for (size_t i = 0; i < run.frames.size(); ++i) {
    if (run.frames[i].status == TrackingStatus::kLost) continue;
    if (!truth.poses[i].world_from_cam.has_value()) continue;
    return *truth.poses[i].world_from_cam *
           run.frames[i].world_from_cam.Inverse();
  }
  return {};
}

ComparedPath PathOf(const LossRun& run, const ComparedPath& truth) {
  const Rigid3d world_from_run = WorldFromRun(run, truth);
  const std::vector<PoseError> errors =
      run.evaluation.value_or(EvaluationReport()).poses;
  auto error = errors.begin();
  ComparedPath path = {run.loss, {}};
  for (size_t i = 0; i < run.frames.size(); ++i) {
    const TrackedFrame& frame = run.frames[i];
    ComparedPose& pose = path.poses.emplace_back();
    pose.timestamp = frame.timestamp;
    if (frame.status != TrackingStatus::kLost) {
      pose.world_from_cam = world_from_run * frame.world_from_cam;
      if (truth.poses[i].world_from_cam.has_value()) {
        const Rigid3d off =
            truth.poses[i].world_from_cam->Inverse() * *pose.world_from_cam;
        pose.distance = off.translation.norm();
        pose.angle = off.Angle();
      }
    }
    if (error != errors.end() && error->timestamp == frame.timestamp) {
      pose.rpe_translation = error->rpe_translation;
      pose.rpe_rotation = error->rpe_rotation;
      ++error;
    }
  }
  return path;
}

std::string Cell(const std::optional<double>& value, double factor = 1.0) {
  return value.has_value() ? Format(",%.6f", *value * factor) : ",";
}

std::string PoseCells(const std::optional<Rigid3d>& pose) {
  if (!pose.has_value()) return ",,,,,,,";
  std::string cells;
  for (const double value : pose->translation) cells += Cell(value);
  for (const double value : pose->rotation.coeffs()) cells += Cell(value);
  return cells;
}

ChartSeries Series(const std::vector<ComparedPath>& paths, size_t k) {
  const std::string& name = paths[k].name;
  if (name == kTruthName) return {name, {"#bbbbbb", "", -1}, 4.0, {}};
  const bool has_truth = paths[0].name == kTruthName;
  ChartSeries series = {name, StyleOf(static_cast<int>(has_truth ? k - 1 : k))};
  series.style.marker = -1;
  return series;
}

ChartPanel TopView(const std::vector<ComparedPath>& paths, int row) {
  ChartPanel panel = {row == 1 ? "X-Y" : "X-Z", "X (m)",
                      row == 1 ? "Y (m)" : "Z (m)"};
  panel.is_map = true;
  for (size_t k = 0; k < paths.size(); ++k) {
    ChartSeries series = Series(paths, k);
    for (const ComparedPose& pose : paths[k].poses) {
      const Eigen::Vector3d p = pose.world_from_cam.has_value()
                                    ? pose.world_from_cam->translation
                                    : Eigen::Vector3d::Constant(NAN);
      series.points.push_back({p.x(), p(row)});
    }
    panel.series.push_back(series);
  }
  return panel;
}

ChartPanel ErrorsOverTime(const std::vector<ComparedPath>& paths,
                          std::optional<double> ComparedPose::*error,
                          double factor, const char* title, const char* label) {
  ChartPanel panel = {title, "time since the first frame (s)", label};
  panel.log_y = true;
  for (size_t k = 1; k < paths.size(); ++k) {
    ChartSeries series = Series(paths, k);
    for (const ComparedPose& pose : paths[k].poses) {
      series.points.push_back(
          {pose.timestamp - paths[k].poses.front().timestamp,
           (pose.*error).value_or(NAN) * factor});
    }
    panel.series.push_back(series);
  }
  return panel;
}

bool HasErrors(const std::vector<ComparedPath>& paths) {
  for (const ComparedPath& path : paths) {
    for (const ComparedPose& pose : path.poses) {
      if (pose.distance.has_value()) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<ComparedPath> ComparePaths(const std::vector<LossRun>& runs,
                                       const std::optional<Trajectory>& truth) {
  const ComparedPath true_path =
      TruthAt(runs.front().frames, truth.value_or(Trajectory()));
  std::vector<ComparedPath> paths;
  if (truth.has_value()) paths.push_back(true_path);
  for (const LossRun& run : runs) paths.push_back(PathOf(run, true_path));
  return paths;
}

std::string ComparedPathsCsvRows(const std::string& name,
                                 const std::vector<ComparedPath>& paths) {
  std::string text;
  for (const ComparedPath& path : paths) {
    for (const ComparedPose& pose : path.poses) {
      text += "\"" + name + "\"," + path.name + Cell(pose.timestamp) +
              PoseCells(pose.world_from_cam) + Cell(pose.distance) +
              Cell(pose.angle, kDegreesPerRadian) + Cell(pose.rpe_translation) +
              Cell(pose.rpe_rotation, kDegreesPerRadian) + "\n";
    }
  }
  return text;
}

std::string PathFigure(const std::string& title,
                       const std::vector<ComparedPath>& paths) {
  Chart chart = {title, {TopView(paths, 1), TopView(paths, 2)}};
  chart.panel_height_px = 300;
  if (HasErrors(paths)) {
    chart.panels.push_back(
        ErrorsOverTime(paths, &ComparedPose::distance, kMillimetresPerMetre,
                       "Distance from the ground truth", "distance (mm)"));
    chart.panels.push_back(
        ErrorsOverTime(paths, &ComparedPose::angle, kDegreesPerRadian,
                       "Angle from the ground truth", "angle (deg)"));
  }
  return FormatSvg(chart);
}

}  // namespace rgbd_pose
