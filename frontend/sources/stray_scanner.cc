#include "core/util/input_error.h"
#include "frontend/sources/source_kinds.h"
#ifdef RGBD_POSE_HAS_VIDEOIO
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <vector>

#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "core/util/units.h"
#include "frontend/files/image_file.h"
#include "frontend/frame/depth_resampling.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/stray_scanner_files.h"
#endif

namespace rgbd_pose {

#ifdef RGBD_POSE_HAS_VIDEOIO

namespace {

namespace fs = std::filesystem;

constexpr int kMaxWidth = 640;         // of frames, px
constexpr uint8_t kMinConfidence = 1;  // of the levels 0, 1 and 2

// The camera of the same image, scaled to a size.
Camera Scaled(const Camera& camera, const cv::Size& size) {
  const double x = static_cast<double>(size.width) / camera.width;
  const double y = static_cast<double>(size.height) / camera.height;
  return {size.width,
          size.height,
          camera.fx * x,
          camera.fy * y,
          (camera.cx + 0.5) * x - 0.5,
          (camera.cy + 0.5) * y - 0.5};
}

// The affine map from pixels of `from` to those of `to`, for cameras at the
// same pose.
cv::Matx23d PixelMap(const Camera& from, const Camera& to) {
  const double x = to.fx / from.fx;
  const double y = to.fy / from.fy;
  return {x, 0.0, to.cx - x * from.cx, 0.0, y, to.cy - y * from.cy};
}

// Opens a video including the images that an edit list hides. OpenCV takes this
// option of FFmpeg from the environment only.
bool OpenWhole(const std::string& path, cv::VideoCapture* video) {
  static std::mutex one_at_a_time;
  const std::lock_guard<std::mutex> lock(one_at_a_time);
  constexpr char kOptions[] = "OPENCV_FFMPEG_CAPTURE_OPTIONS";
  const char* const set = std::getenv(kOptions);
  const std::string before = set == nullptr ? "" : set;
  setenv(kOptions, "ignore_editlist;1", 1);
  // Prevents FFmpeg from printing its own messages about damaged files.
  setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0);
  const bool is_open = video->open(path, cv::CAP_FFMPEG);
  if (set == nullptr) {
    unsetenv(kOptions);
  } else {
    setenv(kOptions, before.c_str(), 1);
  }
  return is_open;
}

// A video that is read image by image, because random access is slow and
// inexact. Skipped images are decoded, since later images depend on them, but
// not converted to pictures, which saves half the time.
class VideoFile {
 public:
  // Opens all images of the file without rotating them.
  explicit VideoFile(const std::string& path) : path_(path) {
    if (!PathExists(path)) {
      throw InputError(path + ": missing; copy the whole folder");
    }
    if (!OpenWhole(path, &video_)) {
      throw InputError(path +
                       ": cannot be read as a video; is it damaged or cut "
                       "off?");
    }
    video_.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);
    size_ = {static_cast<int>(video_.get(cv::CAP_PROP_FRAME_WIDTH)),
             static_cast<int>(video_.get(cv::CAP_PROP_FRAME_HEIGHT))};
    count_ = static_cast<int>(video_.get(cv::CAP_PROP_FRAME_COUNT));
  }

  const std::string& path() const { return path_; }
  cv::Size size() const { return size_; }
  int count() const { return count_; }        // number of images in the header
  int num_read() const { return num_read_; }  // number of calls of Next

  // Advances to the next image and returns a handle for At. If it is released
  // before the next call, the image is skipped.
  std::shared_ptr<cv::Mat> Next() {
    const std::lock_guard<std::mutex> lock(mutex_);
    TakeOut();
    if (!video_.grab()) {
      video_.release();  // what came after would have the wrong number
      throw InputError(path_ + ": only " + std::to_string(num_read_) + " of " +
                       std::to_string(count_) +
                       " images can be decoded; is it damaged or cut off?");
    }
    ++num_read_;
    auto place = std::make_shared<cv::Mat>();
    last_ = place;
    return place;
  }

  // The image of a handle: CV_8UC3 (BGR). Thread-safe.
  const cv::Mat& At(const std::shared_ptr<cv::Mat>& place) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (place->empty()) TakeOut();
    if (place->empty()) throw InputError(path_ + ": an image is damaged");
    return *place;
  }

 private:
  void TakeOut() {
    const std::shared_ptr<cv::Mat> place = last_.lock();
    if (place != nullptr && place->empty()) video_.retrieve(*place);
  }

  std::string path_;
  cv::Size size_;
  int count_ = 0;
  int num_read_ = 0;
  std::mutex mutex_;  // guards the members below
  cv::VideoCapture video_;
  std::weak_ptr<cv::Mat> last_;  // the last handle of Next
};

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
    camera_ = Scaled(ReadStrayCamera(folder_, size),
                     {width, cvRound(static_cast<double>(width) * size.height /
                                     size.width)});
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
          color.clone(), color, PixelMap(camera_, Scaled(focused, size)), size,
          cv::INTER_CUBIC | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
    }
    cv::Mat gray;
    cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
    const cv::Mat depth = ReadDepth(row);
    return assembly_.Make(
        {index, row.timestamp}, {gray, video_.path()}, color,
        {ResampleDepth(depth, size,
                       PixelMap(camera_, Scaled(focused, depth.size()))),
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
