#include "frontend/sources/tum_writer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/locked_folder.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/image_file.h"
#include "frontend/files/imu_calibration_file.h"
#include "frontend/files/imu_file.h"
#include "frontend/sources/frame_stream.h"
#include "frontend/sources/open_source.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

constexpr char kList[] = "rgb.txt";
constexpr char kImuList[] = "imu.csv";

using StampPairs = std::vector<std::pair<double, double>>;  // colour, depth

// As it is written: frames that share a depth image have the same.
double DepthStamp(const Frame& frame) {
  return std::round(1e6 * (frame.timestamp + frame.depth_delay)) / 1e6;
}

std::string ImagePath(const std::string& kind, double timestamp) {
  return kind + Format("/%.6f.png", timestamp);
}

// Changes the colours to have the frame's grey levels when they are read back:
// a JPEG's grey levels differ from those of its colours by up to a few levels.
cv::Mat WithGrayOf(const Frame& frame) {
  cv::Mat color = frame.color.clone();
  for (int y = 0; y < color.rows; ++y) {
    uint8_t* bgr = color.ptr<uint8_t>(y);
    const uint8_t* wanted = frame.gray.ptr<uint8_t>(y);
    for (int x = 0; x < color.cols; ++x, bgr += 3) {
      // First all channels by the difference; if some saturate, in steps of 1.
      for (int turn = 0;; ++turn) {
        const int lack = wanted[x] - GrayLevel(bgr[2], bgr[1], bgr[0]);
        if (lack == 0) break;
        const int step = turn == 0 ? lack : lack > 0 ? 1 : -1;
        for (int k = 0; k < 3; ++k) {
          bgr[k] = cv::saturate_cast<uint8_t>(bgr[k] + step);
        }
      }
    }
  }
  return color;
}

std::string LineOf(const std::string& kind, double stamp) {
  return Format("%.6f ", stamp) + ImagePath(kind, stamp) + "\n";
}

// Writes the lists of images in order. If readers would pair them by time in
// another way, also writes the pairs and returns what readers have to know.
std::string WriteLists(const fs::path& folder, const StampPairs& pairs) {
  std::set<double> color, depth;
  std::string lines;
  for (const auto& [of_color, of_depth] : pairs) {
    color.insert(of_color);
    depth.insert(of_depth);
    lines += Format("%.6f ", of_color) + ImagePath("rgb", of_color) + " " +
             LineOf("depth", of_depth);
  }
  for (const auto& [kind, stamps] :
       {std::pair("rgb", color), {"depth", depth}}) {
    std::string text = "# timestamp filename\n";
    for (const double stamp : stamps) text += LineOf(kind, stamp);
    WriteFileAtomically(folder / (std::string(kind) + ".txt"), text);
  }
  const std::vector<double> first(color.begin(), color.end());
  const std::vector<double> second(depth.begin(), depth.end());
  StampPairs by_time;
  for (const auto& [i, k] :
       Associate(first, second, SourceOptions().max_time_difference)) {
    by_time.emplace_back(first[i], second[k]);
  }
  if (by_time == pairs) return "";
  WriteFileAtomically(folder / "associations.txt", lines);
  return "the pairs of images are not those nearest in time: read them with "
         "--associations=FOLDER/associations.txt";
}

// Adds lines to a file, which is complete after each call. Throws InputError on
// failure (disk full).
void AddLines(const fs::path& path, const std::string& lines) {
  std::ofstream file(path, std::ios::app);
  if (file << lines << std::flush) return;
  throw InputError(path.string() + ": writing failed " + LastFailure());
}

// Adds a frame to the lists of images: what a killed program leaves can be
// read.
void AddToLists(const fs::path& folder, double color,
                std::optional<double> depth) {
  AddLines(folder / kList, LineOf("rgb", color));
  if (!depth.has_value()) return;
  AddLines(folder / "depth.txt", LineOf("depth", *depth));
}

// Writes what is known of an inertial sensor, and the header of its samples.
void BeginImu(const fs::path& folder, const ImuSensor& sensor) {
  WriteFileAtomically(folder / kImuList,
                      FormatImuRows({}, sensor.has_gyro, /*has_header=*/true));
  if (sensor.calibration.IsEmpty()) return;
  WriteFileAtomically(folder / "imu.yaml",
                      FormatImuCalibration(sensor.calibration));
}

// Writes images, from several threads.
class ImageWriter {
 public:
  explicit ImageWriter(const fs::path& folder) : folder_(folder) {}

  void Write(const Frame& frame) {
    WritePngFile(folder_ / ImagePath("rgb", frame.timestamp),
                 frame.color.empty() ? frame.gray : WithGrayOf(frame));
    const double stamp = DepthStamp(frame);
    {
      const std::lock_guard lock(mutex_);
      if (!begun_.insert(stamp).second) return;
    }
    WritePngFile(folder_ / ImagePath("depth", stamp), frame.depth);
  }

 private:
  const fs::path& folder_;
  std::mutex mutex_;
  std::set<double> begun_;  // stamps of depth images; frames may share one
};

// Writes the frames and the inertial samples that come with them.
WrittenSequence WriteFrames(FrameSource* source, const fs::path& folder,
                            const TumWriterOptions& options,
                            StampPairs* pairs) {
  ImageWriter images(folder);
  const std::optional<ImuSensor> imu = source->imu();
  if (imu.has_value()) BeginImu(folder, *imu);
  // The images are written by the threads that read them.
  FrameStream stream(
      source, [&](const Frame& frame) { images.Write(frame); },
      std::max(1, options.threads), options.max_damaged);
  WrittenSequence written;
  while (const std::optional<StreamedFrame> next = stream.Next()) {
    const double color = next->frame.timestamp;
    const double depth = DepthStamp(next->frame);
    const bool is_new = pairs->empty() || pairs->back().second != depth;
    pairs->emplace_back(color, depth);
    AddToLists(folder, color, is_new ? std::optional(depth) : std::nullopt);
    if (!next->imu.empty()) {
      AddLines(folder / kImuList,
               FormatImuRows(next->imu, imu->has_gyro, /*has_header=*/false));
      written.imu_samples += static_cast<int>(next->imu.size());
    }
    ++written.frames;
    if (options.progress) options.progress(written.frames);
    if (!options.stop || !written.stopped.empty()) continue;
    written.stopped = options.stop();
    if (!written.stopped.empty()) stream.End();
  }
  written.damaged = stream.damaged();
  if (written.frames + written.damaged.size() == source->timestamps().size()) {
    written.stopped.clear();  // it was asked to stop at its last frame
  }
  if (written.stopped.empty()) written.stopped = stream.stopped();
  return written;
}

WrittenSequence WriteAll(FrameSource* source, const fs::path& folder,
                         const TumWriterOptions& options) {
  fs::create_directories(folder / "rgb");
  fs::create_directories(folder / "depth");
  RgbdCamera camera = source->camera();
  camera.depth_correction = {};  // the frames are corrected
  WriteFileAtomically((folder / "camera.yaml").string(),
                      FormatCameraFile(camera, ""));
  StampPairs pairs;
  WrittenSequence written = WriteFrames(source, folder, options, &pairs);
  written.remark = WriteLists(folder, pairs);
  const Trajectory ground_truth =
      options.ground_truth ? options.ground_truth() : source->ground_truth();
  if (!ground_truth.empty()) {
    WriteFileAtomically((folder / "groundtruth.txt").string(),
                        FormatTruth(ground_truth, options.truth_noise));
  }
  return written;
}

}  // namespace

WrittenSequence WriteTumSequence(FrameSource* source, const std::string& folder,
                                 const TumWriterOptions& options) {
  try {
    fs::path target = fs::weakly_canonical(folder);
    if (!target.has_filename()) target = target.parent_path();  // "folder/"
    if (fs::exists(target) &&
        (!fs::is_directory(target) || !fs::is_empty(target))) {
      throw InputError(folder +
                       ": already exists and is not an empty folder; remove it "
                       "or choose another");
    }
    fs::remove(target);  // fails now and not at the end, such as a mount point
    const LockedFolder partial(target.string() + ".rgbd_convert.partial",
                               folder + ":", kList);
    WrittenSequence written = WriteAll(source, partial.path(), options);
    fs::rename(partial.path(), target);
    return written;
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder + ": cannot be written: " + error.code().message());
  }
}

}  // namespace rgbd_pose
