#include "frontend/sources/tum_writer.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <system_error>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/image_file.h"
#include "frontend/sources/frame_stream.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

double DepthStamp(const Frame& frame) {
  return frame.timestamp + frame.depth_delay;
}

std::string ImagePath(const std::string& kind, double timestamp) {
  return kind + "/" + FixedNumber(timestamp, 6) + ".png";
}

void WritePng(const fs::path& path, const cv::Mat& image) {
  // Sensor noise contains no repetitions worth a search.
  WritePngFile(path.string(), image,
               {cv::IMWRITE_PNG_COMPRESSION, 1, cv::IMWRITE_PNG_STRATEGY,
                cv::IMWRITE_PNG_STRATEGY_HUFFMAN_ONLY});
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

// The images are written by the threads that read them, the lists at the end.
WrittenSequence WriteAll(FrameSource* source, const fs::path& folder,
                         const TumWriterOptions& options) {
  fs::create_directories(folder / "rgb");
  fs::create_directories(folder / "depth");
  FrameStream stream(
      source,
      [&folder](const Frame& frame) {
        WritePng(folder / ImagePath("rgb", frame.timestamp),
                 frame.color.empty() ? frame.gray : WithGrayOf(frame));
        WritePng(folder / ImagePath("depth", DepthStamp(frame)), frame.depth);
      },
      std::max(1, options.threads), options.max_damaged);
  const std::string head = "# timestamp filename\n";
  std::map<std::string, std::string> lists = {{"rgb", head}, {"depth", head}};
  const auto add = [&lists](const std::string& kind, double stamp) {
    lists[kind] += FixedNumber(stamp, 6) + " " + ImagePath(kind, stamp) + "\n";
  };
  WrittenSequence written;
  while (const std::optional<StreamedFrame> next = stream.Next()) {
    add("rgb", next->frame.timestamp);
    add("depth", DepthStamp(next->frame));
    ++written.frames;
    if (options.progress) options.progress(written.frames);
  }
  for (const auto& [kind, list] : lists) {
    WriteFileAtomically((folder / (kind + ".txt")).string(), list);
  }
  written.damaged = stream.damaged();
  written.stopped = stream.stopped();
  const Trajectory ground_truth =
      options.ground_truth ? options.ground_truth() : source->ground_truth();
  if (!ground_truth.empty()) {
    WriteFileAtomically((folder / "groundtruth.txt").string(),
                        FormatTrajectory(ground_truth));
  }
  RgbdCamera camera = source->camera();
  camera.depth_correction = {};  // the frames are corrected
  WriteFileAtomically((folder / "camera.yaml").string(),
                      FormatCameraFile(camera, ""));
  return written;
}

}  // namespace

WrittenSequence WriteTumSequence(FrameSource* source, const std::string& folder,
                                 const TumWriterOptions& options) {
  fs::path target = fs::path(folder).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();  // "folder/"
  fs::path partial = target;
  partial += ".partial";
  try {
    if (fs::exists(target) &&
        (!fs::is_directory(target) || !fs::is_empty(target))) {
      throw InputError(folder +
                       ": already exists and is not an empty folder; remove it "
                       "or choose another");
    }
    fs::remove_all(partial);
    try {
      WrittenSequence written = WriteAll(source, partial, options);
      fs::rename(partial, target);
      return written;
    } catch (...) {
      std::error_code ignored;
      fs::remove_all(partial, ignored);
      throw;
    }
  } catch (const fs::filesystem_error& error) {
    throw InputError(folder + ": cannot be written: " + error.code().message());
  }
}

}  // namespace rgbd_pose
