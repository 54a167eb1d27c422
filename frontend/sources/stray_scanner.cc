#include "core/util/input_error.h"
#include "frontend/sources/source_kinds.h"
#ifdef RGBD_POSE_HAS_VIDEOIO
#include <algorithm>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/units.h"
#include "frontend/files/image_file.h"
#include "frontend/files/video_file.h"
#include "frontend/frame/depth_resampling.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/scaled_images.h"
#include "frontend/sources/stray_scanner_files.h"
#endif

namespace rgbd_pose {

#ifdef RGBD_POSE_HAS_VIDEOIO

namespace {

namespace fs = std::filesystem;

constexpr int kMaxWidth = 640;         // of frames, px
constexpr uint8_t kMinConfidence = 1;  // of the levels 0, 1 and 2

class StrayScanner final : public FrameSource {
 public:
  explicit StrayScanner(const SourceOptions& options)
      : folder_(options.path),
        video_((folder_ / "rgb.mp4").string()),
        frames_(ReadStrayRows(folder_, video_.size())),
        assembly_(MakeAssembly(options)) {
    if (video_.count() < static_cast<int>(frames_.size())) {
      throw InputError(Format(
          "%s: has %d images, but odometry.csv has %zu rows; copy both from "
          "the phone again",
          video_.path().c_str(), video_.count(), frames_.size()));
    }
    for (const StrayRow& row : frames_) {
      poses_.push_back({row.timestamp, row.world_from_cam});
    }
    const auto end = std::remove_if(
        frames_.begin(), frames_.end(),
        [](const StrayRow& row) { return row.depth_path.empty(); });
    frames_.erase(end, frames_.end());
    if (frames_.empty()) {
      throw InputError((folder_ / "depth").string() +
                       ": has no image (000000.png) of any row of "
                       "odometry.csv; .npy files (old app) are not supported");
    }
  }

  std::optional<RgbdFrame> Next() override {
    if (next_ == frames_.size()) return std::nullopt;
    const int index = next_++;
    std::shared_ptr<cv::Mat> image;
    while (video_.num_read() <= frames_[index].image) image = video_.Next();
    return RgbdFrame{frames_[index].timestamp, [this, index, image] {
                       return Read(index, video_.At(image));
                     }};
  }

  const RgbdCamera& camera() const override { return assembly_.camera(); }
  std::vector<double> timestamps() const override { return TimesOf(frames_); }
  Trajectory ground_truth() const override { return poses_; }
  int unmatched_color() const override {
    return video_.count() - static_cast<int>(frames_.size());
  }

 private:
  FrameAssembly MakeAssembly(const SourceOptions& options) {
    const cv::Size size = video_.size();
    const int width = options.camera.has_value()
                          ? options.camera->camera.width
                          : std::min(size.width, kMaxWidth);
    camera_ = ScaledTo(ReadStrayCamera(folder_, size),
                       {width, cvRound(static_cast<double>(width) *
                                       size.height / size.width)});
    CameraSetup own(camera_);
    own.depth_scale = kMillimetresPerMetre;
    return FrameAssembly(ChooseCamera(options, own), options.keep_color);
  }

  Frame Read(int index, const cv::Mat& image) const {
    const StrayRow& row = frames_[index];
    const cv::Size size(camera_.width, camera_.height);
    const Camera focused = row.camera.value_or(camera_);
    cv::Mat color;
    cv::resize(image, color, size, 0.0, 0.0, cv::INTER_AREA);
    if (row.camera.has_value()) {
      cv::warpAffine(
          color.clone(), color, PixelMap(camera_, ScaledTo(focused, size)),
          size, cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    }
    cv::Mat gray;
    cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
    const cv::Mat depth = ReadDepth(row);
    return assembly_.Make(
        {index, row.timestamp}, {gray, video_.path()}, color,
        {ResampleDepth(depth, size,
                       PixelMap(camera_, ScaledTo(focused, depth.size()))),
         row.depth_path});
  }

  static cv::Mat ReadDepth(const StrayRow& row) {
    cv::Mat depth = ReadDepthImageFile(row.depth_path);
    if (row.confidence_path.empty()) return depth;
    const cv::Mat confidence = ReadGrayImageFile(row.confidence_path);
    if (confidence.size() != depth.size()) {
      throw InputError(row.confidence_path + ": differs in size from " +
                       row.depth_path);
    }
    depth.setTo(0, confidence < kMinConfidence);
    return depth;
  }

  fs::path folder_;
  VideoFile video_;
  std::vector<StrayRow> frames_;  // those with depth
  Trajectory poses_;              // of all rows
  Camera camera_;                 // of all frames, whose focus is made equal
  FrameAssembly assembly_;
  size_t next_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> OpenStrayScanner(const SourceOptions& options) {
  return std::make_unique<StrayScanner>(options);
}

#else

std::unique_ptr<FrameSource> OpenStrayScanner(const SourceOptions& options) {
  throw InputError(
      options.path +
      ": this build cannot read videos; install libopencv-videoio-dev "
      "(scripts/install_dependencies formats) and build again with "
      "RGBD_POSE_VIDEO=ON");
}

#endif

}  // namespace rgbd_pose
