#include "core/util/input_error.h"
#include "frontend/sources/source_kinds.h"
#ifdef RGBD_POSE_HAS_OPENNI2
#include <OpenNI.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <thread>
#include <vector>

#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/image_pairing.h"
#include "frontend/sources/latest_frame.h"
#endif

namespace rgbd_pose {

#ifdef RGBD_POSE_HAS_OPENNI2

namespace {

constexpr char kAny[] = "any";
constexpr int kPatienceMs = 3000;
constexpr std::chrono::milliseconds kFewFrames(150);

// OpenNI's message on its last error, without surrounding white space.
std::string Reason() {
  constexpr char kWhiteSpace[] = " \t\n\v\f\r";
  const std::string reason = openni::OpenNI::getExtendedError();
  const size_t first = reason.find_first_not_of(kWhiteSpace);
  if (first == std::string::npos) return "";
  return reason.substr(first, reason.find_last_not_of(kWhiteSpace) + 1 - first);
}

// How suitable a mode is: best with the image size of TUM's recordings, with
// one of the first formats, and with their rate. 0: its format is not read.
int ScoreOf(const openni::VideoMode& mode,
            const std::vector<openni::PixelFormat>& formats) {
  const auto format =
      std::find(formats.begin(), formats.end(), mode.getPixelFormat());
  if (format == formats.end()) return 0;
  const bool has_size =
      mode.getResolutionX() == 640 && mode.getResolutionY() == 480;
  return (has_size ? 100 : 0) + 10 * static_cast<int>(formats.end() - format) +
         (mode.getFps() == 30 ? 1 : 0);
}

class OpenNi2Source final : public FrameSource {
 public:
  explicit OpenNi2Source(const SourceOptions& options)
      : name_(options.path),
        pairing_(options.max_time_difference,
                 std::chrono::milliseconds(kPatienceMs)) {
    // The library is never shut down, as this would unload drivers, some of
    // which have threads that still run.
    static const openni::Status status = openni::OpenNI::initialize();
    if (status != openni::STATUS_OK) {
      throw InputError("OpenNI 2 cannot be initialised: " + Reason());
    }
    Open(options);
    assembly_ = std::make_unique<FrameAssembly>(
        ChooseCamera(options, OwnCamera(options.camera.has_value())),
        options.keep_color);
    for (openni::VideoStream* stream : {&color_, &depth_}) {
      Check(stream->start(), "cannot be started");
    }
  }
  ~OpenNi2Source() override {
    color_.stop();
    depth_.stop();
    // Some drivers do not wait for their threads, which end one frame later.
    std::this_thread::sleep_for(kFewFrames);
    color_.destroy();
    depth_.destroy();
    device_.close();
  }

  std::optional<RgbdFrame> Next() override {
    return MakeFrame(pairing_.Next(name_, [this] { return Read(); }));
  }

  const RgbdCamera& camera() const override { return assembly_->camera(); }
  int unmatched_color() const override { return pairing_.unmatched_color(); }

 private:
  void Check(openni::Status status, const char* what,
             const char* hint = "") const {
    if (status == openni::STATUS_OK) return;
    const std::string reason = Reason();
    throw InputError(name_ + ": " + what +
                     (reason.empty() ? "" : " (" + reason + ")") + hint);
  }

  void Open(const SourceOptions& options) {
    Check(device_.open(name_ == kAny ? openni::ANY_DEVICE : name_.c_str()),
          "cannot be opened",
          "; check that the camera is plugged in and accessible (OpenNI's udev "
          "rules)");
    Create(openni::SENSOR_COLOR, "colour",
           {openni::PIXEL_FORMAT_RGB888, openni::PIXEL_FORMAT_GRAY8}, &color_);
    Create(openni::SENSOR_DEPTH, "depth",
           {openni::PIXEL_FORMAT_DEPTH_1_MM, openni::PIXEL_FORMAT_DEPTH_100_UM},
           &depth_);
    const bool has_depth_camera =
        options.camera.has_value() && options.camera->depth_camera.has_value();
    if (!has_depth_camera && device_.isImageRegistrationModeSupported(
                                 openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR)) {
      Check(device_.setImageRegistrationMode(
                openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR),
            "cannot register depth to colour");
    }
    // Not every camera supports this; stamps are compared anyway.
    device_.setDepthColorSyncEnabled(true);
  }

  void Create(openni::SensorType type, const char* what,
              const std::vector<openni::PixelFormat>& formats,
              openni::VideoStream* stream) {
    const openni::SensorInfo* sensor = device_.getSensorInfo(type);
    if (sensor == nullptr) {
      throw InputError(name_ + ": has no " + what + " images");
    }
    Check(stream->create(device_, type), "provides no images");
    const auto& modes = sensor->getSupportedVideoModes();
    int best = 0;
    for (int i = 1; i < modes.getSize(); ++i) {
      if (ScoreOf(modes[i], formats) > ScoreOf(modes[best], formats)) best = i;
    }
    if (modes.getSize() == 0 || ScoreOf(modes[best], formats) == 0) {
      throw InputError(name_ + ": has no images in a supported format");
    }
    // A camera with only one mode need not accept settings.
    if (modes.getSize() > 1) {
      Check(stream->setVideoMode(modes[best]),
            "rejects a video mode that it lists");
    }
    stream->setMirroringEnabled(false);
  }

  // With `has_camera` only the depth scale is set.
  std::optional<CameraSetup> OwnCamera(bool has_camera) const {
    CameraSetup setup;
    setup.depth_scale = depth_.getVideoMode().getPixelFormat() ==
                                openni::PIXEL_FORMAT_DEPTH_100_UM
                            ? 10000.0
                            : 1000.0;
    if (has_camera) return setup;
    const openni::VideoMode mode = color_.getVideoMode();
    Camera& camera = setup.camera;
    camera.width = mode.getResolutionX();
    camera.height = mode.getResolutionY();
    const double across = color_.getHorizontalFieldOfView();  // rad
    const double down = color_.getVerticalFieldOfView();
    if (!(across > 0.0 && across < M_PI && down > 0.0 && down < M_PI)) {
      return std::nullopt;
    }
    camera.fx = 0.5 * camera.width / std::tan(0.5 * across);
    camera.fy = 0.5 * camera.height / std::tan(0.5 * down);
    camera.cx = 0.5 * (camera.width - 1);
    camera.cy = 0.5 * (camera.height - 1);
    return setup;
  }

  // Waits for the next image; copies it, as the driver has few frames.
  StreamImage Read() {
    openni::VideoStream* streams[] = {&color_, &depth_};
    int ready = 0;
    Check(openni::OpenNI::waitForAnyStream(streams, 2, &ready, kPatienceMs),
          "sends no more images", "; is it unplugged?");
    openni::VideoFrameRef frame;
    Check(streams[ready]->readFrame(&frame), "provides no image");
    const int type = TypeOf(frame.getVideoMode().getPixelFormat());
    const cv::Mat shared(frame.getHeight(), frame.getWidth(), type,
                         const_cast<void*>(frame.getData()),
                         frame.getStrideInBytes());
    return StreamImage{ready == 0,
                       1e-6 * static_cast<double>(frame.getTimestamp()),
                       shared.clone()};
  }

  int TypeOf(openni::PixelFormat format) const {
    switch (format) {
      case openni::PIXEL_FORMAT_RGB888:
        return CV_8UC3;
      case openni::PIXEL_FORMAT_GRAY8:
        return CV_8UC1;
      case openni::PIXEL_FORMAT_DEPTH_1_MM:
      case openni::PIXEL_FORMAT_DEPTH_100_UM:
        return CV_16UC1;
      default:
        throw InputError(name_ + ": sends images in an unsupported format");
    }
  }

  RgbdFrame MakeFrame(const PairedImages<StreamImage>& pair) {
    const int index = num_frames_++;
    return {pair.color.stamp, [this, index, pair] {
              const auto& [color, depth] = pair;
              cv::Mat gray = color.pixels;
              cv::Mat bgr;
              if (color.pixels.channels() == 3) {
                cv::cvtColor(color.pixels, gray, cv::COLOR_RGB2GRAY);
              }
              if (assembly_->keep_color()) {
                cv::cvtColor(color.pixels, bgr,
                             color.pixels.channels() == 3 ? cv::COLOR_RGB2BGR
                                                          : cv::COLOR_GRAY2BGR);
              }
              return assembly_->Make(
                  {index, color.stamp, depth.stamp - color.stamp},
                  {gray, name_ + ": colour"}, bgr,
                  {depth.pixels, name_ + ": depth"});
            }};
  }

  std::string name_;
  ApproximateTimeSync pairing_;
  openni::Device device_;
  openni::VideoStream color_;
  openni::VideoStream depth_;
  std::unique_ptr<FrameAssembly> assembly_;
  int num_frames_ = 0;
};

}  // namespace

std::unique_ptr<FrameSource> OpenOpenNi2(const SourceOptions& options) {
  return std::make_unique<LatestFrame>(
      std::make_unique<OpenNi2Source>(options));
}

#else

std::unique_ptr<FrameSource> OpenOpenNi2(const SourceOptions& options) {
  throw InputError(options.path +
                   ": this build does not support OpenNI 2; install "
                   "libopenni2-dev (scripts/install_dependencies formats) and "
                   "build again");
}

#endif

}  // namespace rgbd_pose
