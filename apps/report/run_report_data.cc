#include <ceres/loss_function.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/report/report_data.h"
#include "apps/results/cloud_preview.h"
#include "apps/shell/csv_table.h"
#include "core/evaluation/trajectory.h"
#include "core/util/input_error.h"
#include "core/util/quantile.h"
#include "core/util/text_file.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;

std::vector<double> StatusCodes(const CsvTable& frames) {
  std::vector<double> codes;
  for (const std::string& word : frames.Words("status")) {
    codes.push_back(word == "ok" ? 0 : word == "degraded" ? 1 : 2);
  }
  return codes;
}

// Sequences of frames that are not ok, each with the first frame's reason.
json Incidents(const CsvTable& frames) {
  constexpr size_t kMaxIncidents = 100;
  const std::vector<std::string> status = frames.Words("status");
  const std::vector<std::string> reason = frames.Words("reason");
  const std::vector<double> times = Elapsed(frames.Numbers("timestamp"));
  json list = json::array();
  size_t begin = 0;
  while (begin < status.size()) {
    size_t end = begin + 1;
    while (end < status.size() && status[end] == status[begin]) ++end;
    if (status[begin] != "ok" && list.size() < kMaxIncidents) {
      list.push_back({{"first", begin},
                      {"last", end - 1},
                      {"from_s", times[begin]},
                      {"to_s", times[end - 1]},
                      {"status", status[begin]},
                      {"reason", reason[begin]}});
    }
    begin = end;
  }
  return list;
}

json FrameColumns(const CsvTable& frames, const ReportThinning& thinning) {
  json columns = {
      {"t", thinning.First(Elapsed(frames.Numbers("timestamp")), 4)},
      {"status", thinning.Largest(StatusCodes(frames), 0)}};
  for (const char* name : {"segment", "matches", "inliers"}) {
    columns[name] = thinning.First(frames.Numbers(name), 0);
  }
  std::vector<double> by_pixels;
  for (const std::string& source : frames.Words("tracking_source")) {
    by_pixels.push_back(source == "direct");
  }
  columns["by_pixels"] = thinning.First(by_pixels, 0);
  columns["is_reference"] = thinning.Largest(frames.Numbers("is_reference"), 0);
  for (const char* name : {"sigma", "decode_ms", "track_ms", "match_ms",
                           "solve_ms", "reference_ms", "relocalise_ms"}) {
    columns[name] = thinning.Largest(frames.Numbers(name), 3);
  }
  return columns;
}

// The poses of all frames that were not lost.
Trajectory TrackedPoses(const CsvTable& frames,
                        const std::string& trajectory_file) {
  const std::vector<double> status = StatusCodes(frames);
  const size_t tracked =
      status.size() - std::count(status.begin(), status.end(), 2.0);
  Trajectory trajectory;
  if (tracked > 0) trajectory = ReadTrajectory(trajectory_file);
  if (trajectory.size() != tracked) {
    throw InputError(trajectory_file + ": " +
                     std::to_string(trajectory.size()) + " poses, but " +
                     std::to_string(tracked) +
                     " tracked frames in frames.csv; repeat the run");
  }
  return trajectory;
}

// Positions of all frames, null where lost.
json PathOf(const CsvTable& frames, const Trajectory& trajectory,
            const ReportThinning& thinning) {
  std::vector<double> axes[3];
  auto pose = trajectory.begin();
  for (const double code : StatusCodes(frames)) {
    const Eigen::Vector3d position = code < 2
                                         ? (pose++)->world_from_cam.translation
                                         : Eigen::Vector3d::Constant(NAN);
    for (int k = 0; k < 3; ++k) axes[k].push_back(position[k]);
  }
  return {{"x", thinning.First(axes[0], 4)},
          {"y", thinning.First(axes[1], 4)},
          {"z", thinning.First(axes[2], 4)}};
}

// The paths before and after all map corrections, with the same first pose.
json OdometryPath(const CsvTable& frames, const std::string& odometry_file,
                  const std::string& trajectory_file,
                  const ReportThinning& thinning) {
  Trajectory before = TrackedPoses(frames, odometry_file);
  const Trajectory after = TrackedPoses(frames, trajectory_file);
  if (before.empty()) return nullptr;
  const Rigid3d map_from_odom =
      after[0].world_from_cam * before[0].world_from_cam.Inverse();
  for (StampedPose& pose : before) {
    pose.world_from_cam = map_from_odom * pose.world_from_cam;
  }
  return {{"before", PathOf(frames, before, thinning)},
          {"after", PathOf(frames, after, thinning)}};
}

// The path in the world of the ground truth, and the errors of each frame.
void AddErrors(const std::string& file, const ReportThinning& thinning,
               json* data) {
  const CsvTable table = CsvTable::Read(file);
  json path;
  for (const char* name : {"x", "y", "z", "true_x", "true_y", "true_z"}) {
    path[name] = thinning.First(table.Numbers(name), 4);
  }
  (*data)["path"] = path;
  (*data)["errors"] = {
      {"position_m", thinning.Largest(table.Numbers("position_error_m"), 6)},
      {"rpe_m", thinning.Largest(table.Numbers("rpe_m"), 6)},
      {"rpe_deg", thinning.Largest(table.Numbers("rpe_deg"), 4)}};
}

// The most frequent number of residual degrees of freedom; 0 if there are none.
int CommonDegrees(const json& metrics, const std::string& file) {
  const json::json_pointer place("/residuals/degrees_counts");
  const json counts = metrics.contains(place) ? metrics.at(place) : json();
  if (!counts.is_array() ||
      !std::all_of(counts.begin(), counts.end(),
                   [](const json& count) { return count.is_number(); })) {
    throw InputError(file + ": no list of numbers at " + place.to_string() +
                     "; repeat the run");
  }
  return static_cast<int>(std::max_element(counts.begin(), counts.end()) -
                          counts.begin());
}

// The weight of the run's loss as a function of the norm, and the norm up to
// which a match is an inlier. Null if several costs have losses of their own.
json LossCurve(const json& data, const std::string& metrics_file) {
  constexpr double kStep = 0.05;
  constexpr int kSteps = 160;
  const json& metrics = data.at("metrics");
  const std::string name = SettingOf(data.at("settings"), "loss");
  const bool several =
      SettingOf(data.at("settings"), "cost").find('+') != std::string::npos;
  if (FindNamed(MEstimators(), name.substr(0, name.find('('))) == nullptr ||
      several || !metrics.contains("residuals")) {
    return nullptr;
  }
  const int dimension = CommonDegrees(metrics, metrics_file);
  if (dimension == 0) return nullptr;
  const NamedLoss named = ParseLoss(name);
  const std::unique_ptr<ceres::LossFunction> loss = named.Make(dimension);
  json weights = json::array();
  for (int i = 0; i <= kSteps; ++i) {
    const double x = i * kStep;
    double rho[3] = {x * x, 1.0, 0.0};
    if (loss != nullptr) loss->Evaluate(x * x, rho);
    weights.push_back(std::round(std::min(rho[1], 1.0) * 1e4) / 1e4);
  }
  return {{"name", named.row->name},
          {"width", loss ? json(named.Width(dimension)) : json(nullptr)},
          {"limit", std::sqrt(ChiSquared99(dimension))},
          {"step", kStep},
          {"weights", weights}};
}

json ParseJson(const std::string& file) {
  json value =
      json::parse(ReadTextFile(file), nullptr, /*allow_exceptions=*/false);
  if (!value.is_object()) {
    throw InputError(file + ": is not a JSON object; repeat the run");
  }
  return value;
}

}  // namespace

json RunReportData(const std::string& run_folder) {
  const std::filesystem::path folder(run_folder);
  const auto file = [&](const char* name) { return (folder / name).string(); };
  const CsvTable frames = CsvTable::Read(file("frames.csv"));
  const ReportThinning thinning(frames.size(), kMaxReportPoints);
  json data = {{"num_frames", frames.size()},
               {"every", thinning.every},
               {"frames", FrameColumns(frames, thinning)},
               {"incidents", Incidents(frames)},
               {"metrics", ParseJson(file("metrics.json"))},
               {"settings", ReadReportSettings(file("config.flags"))}};
  if (std::filesystem::exists(folder / "errors.csv")) {
    AddErrors(file("errors.csv"), thinning, &data);
  } else {
    data["path"] =
        PathOf(frames, TrackedPoses(frames, file("trajectory.txt")), thinning);
  }
  if (data["metrics"].contains("slam") &&
      std::filesystem::exists(folder / "trajectory_odometry.txt")) {
    data["odometry_path"] =
        OdometryPath(frames, file("trajectory_odometry.txt"),
                     file("trajectory.txt"), thinning);
  }
  data["loss"] = LossCurve(data, file("metrics.json"));
  // The program that made the cloud or mesh writes its preview last, and a new
  // run removes it.
  for (const char* name : {kCloudPreviewFile, kMeshPreviewFile}) {
    if (!std::filesystem::exists(folder / name)) continue;
    data[name == kMeshPreviewFile ? "mesh" : "cloud"] = ParseJson(file(name));
  }
  return data;
}

}  // namespace rgbd_pose
