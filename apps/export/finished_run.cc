#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <system_error>

#include "apps/export/export_format.h"
#include "apps/export/run_states.h"
#include "apps/report/report_data.h"
#include "apps/shell/progress_bar.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/settings/settings.h"
#include "frontend/sources/frame_stream.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// Sets the settings of a table to the flags of a run, where it has them. Throws
// InputError, which names the file of the flags, for values that are none.
void Apply(const nlohmann::json& flags, const std::string& file,
           const std::vector<Setting>& table) {
  for (const Setting& setting : table) {
    const std::string text = SettingOf(flags, setting.name);
    if (text.empty()) continue;
    const auto read = [&](auto* number) {
      const char* const end = text.data() + text.size();
      const auto [stop, error] = std::from_chars(text.data(), end, *number);
      if (stop == end && error == std::errc()) return;
      throw InputError(file + ": '" + text + "' is not a number for --" +
                       setting.name);
    };
    if (auto* named = std::get_if<NamedSetting>(&setting.value)) {
      Located(file, [&] { named->set(text); });
    } else if (int* const* whole = std::get_if<int*>(&setting.value)) {
      read(*whole);
    } else if (double* const* real = std::get_if<double*>(&setting.value)) {
      read(*real);
    } else if (auto* const* words = std::get_if<std::string*>(&setting.value)) {
      **words = text;
    } else {
      *std::get<bool*>(setting.value) = text == "true";
    }
  }
}

// The segment of each frame. In frames.csv it is that known at the time, in
// slam.csv also that of trajectory.txt, where segments that met are one.
std::vector<double> SegmentsOf(const fs::path& run, const CsvTable& frames) {
  const std::string map_frames = (run / "slam.csv").string();
  if (!PathExists(map_frames)) return frames.Numbers("segment");
  const CsvTable table = CsvTable::Read(map_frames);
  if (table.size() != frames.size()) {
    throw InputError(map_frames + ": has " + std::to_string(table.size()) +
                     " frames, but frames.csv " +
                     std::to_string(frames.size()) + "; repeat the run");
  }
  return table.Numbers("final_segment");
}

// What metrics.json says of gravity in the world of a segment; nothing if it is
// not known there.
std::optional<Eigen::Vector3d> ReadUp(const fs::path& metrics, int segment) {
  if (!PathExists(metrics)) return std::nullopt;
  const auto json = nlohmann::json::parse(ReadTextFile(metrics), nullptr,
                                          /*allow_exceptions=*/false);
  const auto gravity = json.find("gravity");
  if (gravity == json.end() || !gravity->contains("up")) return std::nullopt;
  if (gravity->value("segment", 0) != segment) return std::nullopt;
  const nlohmann::json& up = gravity->at("up");
  const auto is_number = [](const nlohmann::json& value) {
    return value.is_number();
  };
  if (up.size() != 3 || !std::all_of(up.begin(), up.end(), is_number)) {
    throw InputError(metrics.string() +
                     ": up of gravity must be three numbers; run again, or "
                     "delete gravity");
  }
  return Eigen::Vector3d(up[0].get<double>(), up[1].get<double>(),
                         up[2].get<double>());
}

// The frames of a source at the given times.
class PickedFrames final : public FrameSource {
 public:
  PickedFrames(FrameSource* source, std::vector<double> times)
      : source_(source), times_(std::move(times)) {}

  std::optional<RgbdFrame> Next() override {
    if (next_ == times_.size()) return std::nullopt;
    while (std::optional<RgbdFrame> frame = source_->Next()) {
      if (frame->timestamp < times_[next_] - kSameTime) continue;
      if (frame->timestamp > times_[next_] + kSameTime) break;
      ++next_;
      return frame;
    }
    throw InputError(
        "the recording has no frame at " + Format("%.6f", times_[next_]) +
        " s, but the run has; give the recording of this run (--dataset)");
  }
  const RgbdCamera& camera() const override { return source_->camera(); }

 private:
  FrameSource* source_;
  std::vector<double> times_;
  size_t next_ = 0;
};

}  // namespace

FinishedRun::FinishedRun(const std::string& run_folder,
                         const std::string& dataset, const std::string& camera)
    : folder(run_folder) {
  const fs::path path(folder);
  std::error_code error;
  if (!fs::is_directory(path, error)) {
    throw InputError("--run: " + folder + ": no such folder");
  }
  for (const char* file : {"frames.csv", "config.flags"}) {
    if (!PathExists(path / file)) {
      throw InputError("--run: " + folder + " has no " + file +
                       "; give a results folder of rgbd_odometry or rgbd_slam");
    }
  }
  const std::string file = path / "config.flags";
  const nlohmann::json flags = ReadReportSettings(file);
  Apply(flags, file, SettingTable(&sequence));
  Apply(flags, file, SettingTable(&odometry));
  if (!dataset.empty()) sequence.dataset = dataset;
  if (!camera.empty()) sequence.camera = camera;

  const CsvTable table = CsvTable::Read(path / "frames.csv");
  const std::vector<std::string> status = table.Words("status");
  const std::vector<double> segment = SegmentsOf(path, table);
  for (size_t i = 0; i < status.size(); ++i) {
    if (status[i] == "lost") continue;
    frames.push_back(static_cast<int>(i));
    segments.push_back(static_cast<int>(segment[i]));
  }
  lost = static_cast<int>(status.size() - frames.size());
  if (frames.empty()) {
    throw InputError("--run: " + folder + ": no frame of the run has a pose");
  }
  trajectory = ReadTrajectory(path / "trajectory.txt");
  if (trajectory.size() != frames.size()) {
    throw InputError("--run: " + folder + ": trajectory.txt has " +
                     std::to_string(trajectory.size()) + " poses, but " +
                     std::to_string(frames.size()) +
                     " tracked frames in frames.csv; repeat the run");
  }
  if (const auto up = ReadUp(path / "metrics.json", segments[0])) {
    level_from_world = LevelFromWorld(*up);
  }
}

FinishedRun::FinishedRun(Trajectory path, Open open)
    : open(std::move(open)),
      trajectory(std::move(path)),
      frames(trajectory.size()),
      segments(trajectory.size(), 0) {
  if (trajectory.empty()) throw InputError("the path has no poses");
  std::iota(frames.begin(), frames.end(), 0);
}

Rigid3d LevelFromWorld(const Eigen::Vector3d& up) {
  const Eigen::Vector3d down = -up.normalized();
  // Ahead is z, the optical axis of the first camera; in an upright world y.
  Eigen::Vector3d ahead = Eigen::Vector3d::UnitZ();
  constexpr double kNearlyVertical = 0.9;
  if (std::abs(ahead.dot(down)) > kNearlyVertical) {
    ahead = Eigen::Vector3d::UnitY();
  }
  ahead = (ahead - ahead.dot(down) * down).normalized();
  Eigen::Matrix3d rows;
  rows << down.cross(ahead).transpose(), down.transpose(), ahead.transpose();
  return Rigid3d(Eigen::Quaterniond(rows), Eigen::Vector3d::Zero());
}

std::unique_ptr<FrameSource> OpenRecording(const FinishedRun& run) {
  if (run.open != nullptr) return run.open();
  SequenceSettings settings = run.sequence;
  if (!PathExists(settings.dataset)) {
    throw InputError("the recording of the run, " + settings.dataset +
                     ", does not exist; give its location with --dataset");
  }
  // An export needs only the frames.
  settings.motion_guess.clear();
  settings.groundtruth = "none";
  return OpenSequence(settings, /*keep_color=*/true).source;
}

std::vector<int> ReadViews(const FinishedRun& run, const ExportOptions& options,
                           FrameSource* source, const OnView& on_view) {
  const Trajectory& poses = run.trajectory;
  std::vector<int> views;
  std::vector<double> times;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (run.segments[i] != run.segments[0]) continue;
    if (views.empty() ||
        options.step.IsReached(poses[views.back()].world_from_cam.Inverse() *
                               poses[i].world_from_cam)) {
      views.push_back(static_cast<int>(i));
      times.push_back(poses[i].timestamp);
    }
  }
  PickedFrames picked(source, times);
  std::optional<ProgressBar> bar;
  if (options.on_frame == nullptr) {
    bar.emplace("reading", static_cast<int>(views.size()));
  }
  FrameStream stream(&picked, nullptr, options.threads);
  int done = 0;
  for (const int view : views) {
    on_view(stream.Next()->frame, view);
    ++done;
    if (bar.has_value()) bar->Update(done);
    if (options.on_frame != nullptr) options.on_frame();
  }
  return views;
}

}  // namespace rgbd_pose
