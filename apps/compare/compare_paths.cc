#include "apps/compare/compare_paths.h"

#include <cmath>
#include <limits>

#include "apps/figures/svg_chart.h"
#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// The truth at the times of all frames, where it has a pose close in time.
ComparedPath TruthAt(const std::vector<TrackedFrame>& frames,
                     const Trajectory& truth) {
  std::vector<double> times;
  times.reserve(truth.size());
  for (const StampedPose& pose : truth) times.push_back(pose.timestamp);
  ComparedPath path;
  path.name = kTruthName;
  for (const TrackedFrame& frame : frames) {
    ComparedPose pose;
    pose.timestamp = frame.timestamp;
    const size_t nearest = NearestTime(times, frame.timestamp);
    if (std::abs(times[nearest] - frame.timestamp) <=
        EvaluationOptions().max_time_difference) {
      pose.world_from_cam = truth[nearest].world_from_cam;
    }
    path.poses.push_back(pose);
  }
  return path;
}

// The motion that aligns a run with the truth at their first common pose.
Rigid3d WorldFromRun(const LossRun& run, const ComparedPath* truth) {
  if (truth == nullptr) return {};
  for (size_t i = 0; i < run.frames.size(); ++i) {
    if (run.frames[i].status == TrackingStatus::kLost) continue;
    if (!truth->poses[i].world_from_cam.has_value()) continue;
    return *truth->poses[i].world_from_cam *
           run.frames[i].world_from_cam.Inverse();
  }
  return {};
}

ComparedPath PathOf(const LossRun& run, const ComparedPath* truth) {
  const Rigid3d world_from_run = WorldFromRun(run, truth);
  ComparedPath path;
  path.name = run.loss;
  size_t next_error = 0;
  for (size_t i = 0; i < run.frames.size(); ++i) {
    const TrackedFrame& frame = run.frames[i];
    ComparedPose pose;
    pose.timestamp = frame.timestamp;
    if (frame.status != TrackingStatus::kLost) {
      pose.world_from_cam = world_from_run * frame.world_from_cam;
      if (truth != nullptr && truth->poses[i].world_from_cam.has_value()) {
        const Rigid3d error =
            truth->poses[i].world_from_cam->Inverse() * *pose.world_from_cam;
        pose.distance = error.translation.norm();
        pose.angle = error.Angle();
      }
    }
    if (run.evaluation.has_value() &&
        next_error < run.evaluation->poses.size() &&
        run.evaluation->poses[next_error].timestamp == frame.timestamp) {
      pose.rpe_translation = run.evaluation->poses[next_error].rpe_translation;
      pose.rpe_rotation = run.evaluation->poses[next_error].rpe_rotation;
      ++next_error;
    }
    path.poses.push_back(pose);
  }
  return path;
}

void AddCell(const std::optional<double>& value, double factor,
             std::string* row) {
  *row += value.has_value() ? Format(",%.6f", *value * factor) : ",";
}

void AddPose(const std::optional<Rigid3d>& pose, std::string* row) {
  if (!pose.has_value()) {
    *row += ",,,,,,,";
    return;
  }
  for (const double value : pose->translation) AddCell(value, 1.0, row);
  for (const double value : pose->rotation.coeffs()) AddCell(value, 1.0, row);
}

ChartSeries Series(const std::vector<ComparedPath>& paths, size_t k) {
  ChartSeries series;
  series.label = paths[k].name;
  if (paths[k].name == kTruthName) {
    series.style = {"#bbbbbb", "", -1};
    series.width_px = 4.0;
    return series;
  }
  const bool has_truth = paths[0].name == kTruthName;
  series.style = StyleOf(static_cast<int>(has_truth ? k - 1 : k));
  series.style.marker = -1;
  return series;
}

ChartPanel TopView(const std::vector<ComparedPath>& paths, int row) {
  ChartPanel panel;
  panel.title = row == 1 ? "X-Y" : "X-Z";
  panel.x_label = "X (m)";
  panel.y_label = row == 1 ? "Y (m)" : "Z (m)";
  panel.is_map = true;
  for (size_t k = 0; k < paths.size(); ++k) {
    ChartSeries series = Series(paths, k);
    for (const ComparedPose& pose : paths[k].poses) {
      const Eigen::Vector3d p = pose.world_from_cam.has_value()
                                    ? pose.world_from_cam->translation
                                    : Eigen::Vector3d::Constant(kNaN);
      series.points.push_back({p.x(), p(row)});
    }
    panel.series.push_back(series);
  }
  return panel;
}

ChartPanel ErrorsOverTime(const std::vector<ComparedPath>& paths,
                          std::optional<double> ComparedPose::*error,
                          double factor) {
  ChartPanel panel;
  panel.x_label = "time since the first frame (s)";
  panel.log_y = true;
  for (size_t k = 1; k < paths.size(); ++k) {
    ChartSeries series = Series(paths, k);
    for (const ComparedPose& pose : paths[k].poses) {
      series.points.push_back(
          {pose.timestamp - paths[k].poses.front().timestamp,
           (pose.*error).value_or(kNaN) * factor});
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
  std::vector<ComparedPath> paths;
  std::optional<ComparedPath> true_path;
  if (truth.has_value()) {
    true_path = TruthAt(runs.front().frames, *truth);
    paths.push_back(*true_path);
  }
  for (const LossRun& run : runs) {
    paths.push_back(PathOf(run, true_path ? &*true_path : nullptr));
  }
  return paths;
}

const char kComparedPathsCsvHeader[] =
    "sequence,loss,timestamp,x,y,z,qx,qy,qz,qw,distance_m,angle_deg,"
    "rpe_seconds_m,rpe_seconds_deg\n";

std::string ComparedPathsCsvRows(const std::string& name,
                                 const std::vector<ComparedPath>& paths) {
  std::string text;
  for (const ComparedPath& path : paths) {
    for (const ComparedPose& pose : path.poses) {
      std::string row = "\"" + name + "\"," + path.name;
      AddCell(pose.timestamp, 1.0, &row);
      AddPose(pose.world_from_cam, &row);
      AddCell(pose.distance, 1.0, &row);
      AddCell(pose.angle, kDegreesPerRadian, &row);
      AddCell(pose.rpe_translation, 1.0, &row);
      AddCell(pose.rpe_rotation, kDegreesPerRadian, &row);
      text += row + "\n";
    }
  }
  return text;
}

std::string PathFigure(const std::string& title,
                       const std::vector<ComparedPath>& paths) {
  Chart chart;
  chart.title = title;
  chart.panel_height_px = 300;
  chart.panels = {TopView(paths, 1), TopView(paths, 2)};
  if (HasErrors(paths)) {
    ChartPanel distance =
        ErrorsOverTime(paths, &ComparedPose::distance, kMillimetresPerMetre);
    distance.title = "Distance from the ground truth";
    distance.y_label = "distance (mm)";
    ChartPanel angle =
        ErrorsOverTime(paths, &ComparedPose::angle, kDegreesPerRadian);
    angle.title = "Angle from the ground truth";
    angle.y_label = "angle (deg)";
    chart.panels.push_back(distance);
    chart.panels.push_back(angle);
  }
  return FormatSvg(chart);
}

}  // namespace rgbd_pose
