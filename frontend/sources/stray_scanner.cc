#include "core/util/input_error.h"
#include "frontend/sources/source_kinds.h"
#ifdef RGBD_POSE_HAS_VIDEOIO
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "core/evaluation/association.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/files/image_file.h"
#include "frontend/files/video_file.h"
#include "frontend/frame/depth_resampling.h"
#include "frontend/sources/frame_assembly.h"
#endif

namespace rgbd_pose {

#ifdef RGBD_POSE_HAS_VIDEOIO

namespace {

namespace fs = std::filesystem;

constexpr int kMaxWidth = 640;         // of frames, px
constexpr double kMillimetres = 1e3;   // depth units per metre
constexpr uint8_t kMinConfidence = 1;  // of the levels 0, 1 and 2

constexpr std::array<const char*, 9> kOdometryColumns = {
    "timestamp", "frame", "x", "y", "z", "qx", "qy", "qz", "qw"};

// A row of odometry.csv. The video has one image for each row.
struct StrayRow {
  double timestamp = 0.0;        // s
  Rigid3d world_from_cam;        // by ARKit; the app has turned the camera axes
  std::optional<Camera> camera;  // of this image, whose focus varies
  int image = 0;                 // number in the video
  std::string depth_path;        // empty: none
  std::string confidence_path;
};

// The path of a numbered image, with or without leading zeros; empty: none.
std::string NumberedImage(const fs::path& folder, double number) {
  for (const char* name : {"%06.0f.png", "%.0f.png"}) {
    const fs::path path = folder / Format(name, number);
    if (PathExists(path)) return path.string();
  }
  return "";
}

StrayRow ParseRow(const fs::path& folder, const cv::Size& size,
                  const std::string& path, const TextLine& line) {
  std::vector<double> values;
  for (const std::string& word : line.words) {
    values.push_back(ParseNumber(word, path, line.number, "row of a frame"));
  }
  if (values.size() < kOdometryColumns.size()) {
    throw InputError(path, line.number,
                     "needs 9 columns, has " + std::to_string(values.size()) +
                         "; was the file cut off?");
  }
  const Eigen::Quaterniond turn(values[8], values[5], values[6], values[7]);
  if (std::abs(turn.norm() - 1.0) > 0.01) {
    throw InputError(path, line.number, "its quaternion has no unit length");
  }
  StrayRow row;
  row.timestamp = ParseTimestamp(line.words[0], path, line.number);
  row.world_from_cam = Rigid3d(turn, {values[2], values[3], values[4]});
  // Newer versions of the app add these columns.
  if (values.size() >= kOdometryColumns.size() + 4) {
    row.camera = Camera{size.width, size.height, values[9],
                        values[10], values[11],  values[12]};
    RequireSound(row.camera->Check(),
                 Format("%s:%d: ", path.c_str(), line.number));
  }
  row.depth_path = NumberedImage(folder / "depth", values[1]);
  row.confidence_path = NumberedImage(folder / "confidence", values[1]);
  return row;
}

// Reads odometry.csv for a video of this size.
std::vector<StrayRow> ReadStrayRows(const fs::path& folder,
                                    const cv::Size& size) {
  const std::string path = (folder / "odometry.csv").string();
  std::vector<TextLine> lines = ReadTextTable(path);
  if (lines.empty() || lines[0].words.size() < kOdometryColumns.size() ||
      !std::equal(kOdometryColumns.begin(), kOdometryColumns.end(),
                  lines[0].words.begin())) {
    throw InputError(path +
                     ": needs the columns timestamp, frame, x, y, z, qx, qy, "
                     "qz, qw, as Stray Scanner writes them since version 1.2");
  }
  std::vector<StrayRow> rows;
  for (size_t i = 1; i < lines.size(); ++i) {
    rows.push_back(ParseRow(folder, size, path, lines[i]));
    rows.back().image = static_cast<int>(i) - 1;
    if (i > 1 && rows[i - 1].timestamp <= rows[i - 2].timestamp) {
      throw InputError(path, lines[i].number,
                       "is no later than the row before");
    }
  }
  return rows;
}

Camera ReadCameraMatrix(const std::string& path, const cv::Size& size) {
  std::vector<double> k;
  for (const TextLine& line : ReadTextTable(path)) {
    for (const std::string& word : line.words) {
      k.push_back(ParseNumber(word, path, line.number, "camera matrix"));
    }
  }
  if (k.size() != 9 || k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 ||
      k[7] != 0.0 || k[8] != 1.0) {
    throw InputError(path +
                     ": is no camera matrix fx, 0, cx; 0, fy, cy; 0, 0, 1");
  }
  const Camera camera = {size.width, size.height, k[0], k[4], k[2], k[5]};
  RequireSound(camera.Check(), path + ": ");
  return camera;
}

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

class StrayScanner final : public FrameSource {
 public:
  explicit StrayScanner(const SourceOptions& options)
      : folder_(options.path),
        video_((folder_ / "rgb.mp4").string()),
        frames_(ReadStrayRows(folder_, video_.size())),
        assembly_(MakeAssembly(options)) {
    if (video_.count() < static_cast<int>(frames_.size())) {
      throw InputError(Format(
          "%s: has %d images, odometry.csv %zu rows: which belong together is "
          "not known; copy both from the phone once more",
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
                       ": has no image (000000.png) of a row of odometry.csv; "
                       "what old versions of the app write (.npy) is not read");
    }
  }

  std::optional<RgbdFrame> Next() override {
    if (next_ == frames_.size()) return std::nullopt;
    const size_t index = next_++;
    std::shared_ptr<cv::Mat> image;
    for (; num_decoded_ <= frames_[index].image; ++num_decoded_) {
      image = video_.Next();
    }
    return RgbdFrame{frames_[index].timestamp, [this, index, image] {
                       Frame frame = Read(frames_[index], video_.At(image));
                       frame.index = static_cast<int>(index);
                       return frame;
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
    camera_ = Scaled(
        ReadCameraMatrix((folder_ / "camera_matrix.csv").string(), size),
        {width,
         cvRound(static_cast<double>(width) * size.height / size.width)});
    CameraSetup own(camera_);
    own.depth_scale = kMillimetres;
    return FrameAssembly(ChooseCamera(options, own), options.keep_color);
  }

  Frame Read(const StrayRow& row, const cv::Mat& image) const {
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
    Frame frame = assembly_.Make(
        {gray, video_.path()}, color,
        {ResampleDepth(depth, size,
                       PixelMap(camera_, Scaled(focused, depth.size()))),
         row.depth_path});
    frame.timestamp = row.timestamp;
    return frame;
  }

  static cv::Mat ReadDepth(const StrayRow& row) {
    cv::Mat depth = ReadDepthImageFile(row.depth_path);
    if (row.confidence_path.empty()) return depth;
    const cv::Mat confidence = ReadGrayImageFile(row.confidence_path);
    if (confidence.size() != depth.size()) {
      throw InputError(row.confidence_path + ": has another size than " +
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
  int num_decoded_ = 0;  // number of images
};

}  // namespace

std::unique_ptr<FrameSource> OpenStrayScanner(const SourceOptions& options) {
  return std::make_unique<StrayScanner>(options);
}

#else

std::unique_ptr<FrameSource> OpenStrayScanner(const SourceOptions& options) {
  throw InputError(
      options.path +
      ": this build reads no videos; install libopencv-videoio-dev "
      "(scripts/install_dependencies formats) and build again, with "
      "RGBD_POSE_VIDEO=ON");
}

#endif

}  // namespace rgbd_pose
