#include "frontend/sources/imu_beside.h"

#include <filesystem>
#include <utility>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/imu_calibration_file.h"
#include "frontend/files/imu_file.h"
#include "frontend/sources/imu_feed.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

// TUM's file of the accelerometer in a Kinect.
constexpr char kKinectFile[] = "accelerometer.txt";

constexpr char kAdvice[] = "; imu=none (--imu=none) leaves the sensor out";

class SourceWithImu final : public FrameSource {
 public:
  SourceWithImu(std::unique_ptr<FrameSource> source, const ImuSensor& sensor,
                std::string remark)
      : source_(std::move(source)),
        sensor_(sensor),
        remark_(std::move(remark)),
        feed_(sensor.calibration.delay_s.value_or(0.0)) {}

  void Add(const ImuSample& sample) { feed_.Add(sample); }

  std::optional<RgbdFrame> Next() override {
    std::optional<RgbdFrame> next = source_->Next();
    if (next.has_value()) next->imu = feed_.Take(next->timestamp);
    return next;
  }

  std::optional<ImuSensor> imu() const override { return sensor_; }
  const RgbdCamera& camera() const override { return source_->camera(); }
  std::vector<double> timestamps() const override {
    return source_->timestamps();
  }
  Trajectory ground_truth() const override { return source_->ground_truth(); }
  int unmatched_color() const override { return source_->unmatched_color(); }
  int dropped() const override { return source_->dropped(); }
  std::vector<std::string> remarks() const override {
    std::vector<std::string> lines = source_->remarks();
    if (!remark_.empty()) lines.push_back(remark_);
    return lines;
  }

 private:
  std::unique_ptr<FrameSource> source_;
  ImuSensor sensor_;
  std::string remark_;
  ImuFeed feed_;
};

// The file of samples in a folder; empty if there is none.
std::string FileIn(const fs::path& folder) {
  for (const char* name : {"imu.csv", "imu.txt", kKinectFile}) {
    if (PathExists(folder / name)) return (folder / name).string();
  }
  return "";
}

// The axes of a Kinect's accelerometer in those of its colour camera. Turned by
// the true poses of fr1/xyz and fr1/rpy its mean is 4.3 and 3.4 degrees off
// motion capture's z axis. The translation is not known.
Rigid3d KinectMounting() {
  return Rigid3d(Eigen::Quaterniond(0.0, 0.0, 0.0, 1.0),  // (-x, -y, z)
                 Eigen::Vector3d::Zero());
}

// Throws InputError if no sample is at the time of the frames.
void CheckTimes(const std::string& file, const std::vector<ImuSample>& samples,
                double delay, const std::vector<double>& frames) {
  if (frames.empty()) return;
  const double first = samples.front().stamp - delay;
  const double last = samples.back().stamp - delay;
  if (first <= frames.back() && last >= frames.front()) return;
  throw InputError(
      file + Format(": samples from %.6f to %.6f s by the camera's clock, "
                    "frames from %.6f to %.6f s; do they use the same clock "
                    "(timeshift_cam_imu)?",
                    first, last, frames.front(), frames.back()));
}

}  // namespace

ImuCalibration ChooseImuCalibration(const SourceOptions& options) {
  ImuCalibration chosen;
  if (!options.imu.empty()) chosen = ReadImuCalibrationFile(options.imu);
  if (options.camera.has_value()) chosen.CompleteFrom(options.camera->imu);
  const fs::path folder = options.path;
  if (PathExists(folder / "imu.yaml")) {
    chosen.CompleteFrom(ReadImuCalibrationFile((folder / "imu.yaml").string()));
  }
  if (PathExists(folder / "camera.yaml")) {
    chosen.CompleteFrom(ReadImuCalibration(
        YamlSection::FromFile((folder / "camera.yaml").string())));
  }
  return chosen;
}

std::unique_ptr<FrameSource> WithImu(std::unique_ptr<FrameSource> source,
                                     const std::vector<ImuSample>& samples,
                                     const ImuSensor& sensor,
                                     const std::string& remark) {
  auto with =
      std::make_unique<SourceWithImu>(std::move(source), sensor, remark);
  for (const ImuSample& sample : samples) with->Add(sample);
  return with;
}

std::unique_ptr<FrameSource> WithImuBeside(std::unique_ptr<FrameSource> source,
                                           const SourceOptions& options) {
  if (options.imu == SourceOptions::kNoImu || source->imu().has_value()) {
    return source;
  }
  const std::string file = FileIn(options.path);
  if (file.empty()) {
    if (options.imu.empty()) return source;
    throw InputError(options.path +
                     ": has no samples of an inertial sensor (imu.csv, "
                     "imu.txt, accelerometer.txt)" +
                     kAdvice);
  }
  try {
    const ImuRecording recording = ReadImuFile(file);
    ImuCalibration calibration = ChooseImuCalibration(options);
    calibration.CompleteFrom({recording.cam_from_imu, {}, {}});
    if (fs::path(file).filename() == kKinectFile) {
      calibration.CompleteFrom({KinectMounting(), {}, {}});
    }
    CheckTimes(file, recording.samples, calibration.delay_s.value_or(0.0),
               source->timestamps());
    return WithImu(
        std::move(source), recording.samples, {calibration, recording.has_gyro},
        recording.warning.empty() ? "" : file + ": " + recording.warning);
  } catch (const InputError& error) {
    throw InputError(error.what() + std::string(kAdvice));
  }
}

}  // namespace rgbd_pose
