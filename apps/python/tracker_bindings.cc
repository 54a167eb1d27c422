#include "apps/python/tracker_bindings.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/util/input_error.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// Depths in metres are converted to raw units of 0.2 mm, finer than any sensor.
constexpr double kUnitsPerMetre = 5000.0;

constexpr double kDefaultFrameRate = 30.0;  // Hz

// The number of channels; 0 if the array is not an image of the camera's size.
int Channels(const py::array& array, const Camera& camera) {
  if (array.ndim() < 2 || array.ndim() > 3) return 0;
  if (array.shape(0) != camera.height || array.shape(1) != camera.width) {
    return 0;
  }
  return array.ndim() == 2 ? 1 : static_cast<int>(array.shape(2));
}

InputError WrongImage(const std::string& name, const py::array& array,
                      const Camera& camera, const std::string& needed) {
  return InputError(name + ": is " + std::string(py::str(array.dtype())) +
                    " of shape " + std::string(py::str(array.attr("shape"))) +
                    "; it needs " + needed + " of the camera's " +
                    std::to_string(camera.height) + " x " +
                    std::to_string(camera.width) + " pixels");
}

// A copy of an array of this type of pixels, of any strides.
template <typename T>
cv::Mat CopyOf(const py::array& array, const Camera& camera, int type) {
  const py::array_t<T, py::array::c_style | py::array::forcecast> rows(array);
  return cv::Mat(camera.height, camera.width, type, const_cast<T*>(rows.data()))
      .clone();
}

cv::Mat GrayFrom(const py::object& object, const Camera& camera) {
  const py::array array = ToArray(object, "image");
  const int channels = Channels(array, camera);
  if (!py::isinstance<py::array_t<uint8_t>>(array) ||
      (channels != 1 && channels != 3)) {
    throw WrongImage("image", array, camera, "uint8, grey or RGB,");
  }
  cv::Mat gray = CopyOf<uint8_t>(array, camera, CV_8UC(channels));
  if (channels == 3) cv::cvtColor(gray, gray, cv::COLOR_RGB2GRAY);
  return gray;
}

}  // namespace

std::string FrameInWords(const TrackedFrame& frame) {
  std::string text =
      std::to_string(frame.index) + ": " + ToString(frame.status);
  if (!frame.reason.empty()) text += ", " + frame.reason;
  return text + ", " + std::to_string(frame.inliers) + " of " +
         std::to_string(frame.matches) + " matches agree";
}

Frame FrameFromArrays(const py::object& image, const py::object& depth,
                      const RgbdCamera& camera) {
  Frame frame;
  frame.color_shutter = camera.color_shutter;
  frame.depth_shutter = camera.depth_shutter;
  frame.gray = GrayFrom(image, camera.camera);
  py::array array = ToArray(depth, "depth");
  // Many libraries store single-channel images in this way.
  if (array.ndim() == 3 && array.shape(2) == 1) {
    array = array.attr("squeeze")(2);
  }
  // Of any byte order: that of PGM files is big-endian.
  const bool is_raw = array.dtype().kind() == 'u' && array.itemsize() == 2;
  if (Channels(array, camera.camera) != 1 || array.ndim() != 2 ||
      !(is_raw || array.dtype().kind() == 'f')) {
    throw WrongImage("depth", array, camera.camera,
                     "uint16 (raw units) or float32 (metres)");
  }
  frame.depth_scale = is_raw ? camera.depth_scale : kUnitsPerMetre;
  if (is_raw) {
    frame.depth = CopyOf<uint16_t>(array, camera.camera, CV_16UC1);
    return frame;
  }
  const int height = camera.camera.height, width = camera.camera.width;
  const NumberArray metres(array, "depth", {height, width});
  frame.depth.create(height, width, CV_16UC1);
  int used = 0, too_far = 0;
  for (int y = 0; y < height; ++y) {
    auto* to = frame.depth.ptr<uint16_t>(y);
    for (int x = 0; x < width; ++x) {
      const double raw = std::round(metres(y, x) * kUnitsPerMetre);
      const bool is_valid = raw > 0.0 && raw < Frame::kNoDepth;  // NaN is not
      to[x] = is_valid ? static_cast<uint16_t>(raw) : 0;
      used += is_valid;
      too_far += raw >= Frame::kNoDepth;
    }
  }
  if (too_far > used) {
    WarnUser(
        "depth: most values are above 13 m and are not used; check the depth "
        "scale: float32 is in metres, millimetres are uint16 with a camera of "
        "depth_scale=1000");
  }
  return frame;
}

std::vector<ImuSample> ImuSamplesFrom(const py::object& array) {
  const NumberArray rows(array, "samples", {NumberArray::kAny, 7});
  std::vector<ImuSample> samples(rows.size());
  for (size_t i = 0; i < rows.size(); ++i) {
    samples[i].stamp = rows(i, 0);
    for (int axis = 0; axis < 3; ++axis) {
      samples[i].gyro[axis] = rows(i, 1 + axis);
      samples[i].accel[axis] = rows(i, 4 + axis);
    }
  }
  return samples;
}

void SharedRun::UseImu(const ImuSensor& sensor) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!run_.frames().empty()) {
    throw InputError("use_imu: call it before the first frame");
  }
  run_.UseImu(sensor);
  uses_imu_ = true;
}

void SharedRun::AddImu(const std::vector<ImuSample>& samples) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!uses_imu_) {
    throw InputError("add_imu: call use_imu first, which says how to use them");
  }
  run_.AddImu(samples);
}

std::string SharedRun::OpenView(const std::string& title,
                                const ViewSettings& settings) {
  const std::lock_guard<std::mutex> lock(mutex_);
  view_.reset();  // frees its port
  view_ = std::make_unique<LiveView>(title, settings, camera_.camera, run_);
  return view_->address();
}

void SharedRun::CloseView() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (view_ != nullptr) view_->Finish("");
}

bool SharedRun::IsStopped() {
  const std::lock_guard<std::mutex> lock(mutex_);
  return view_ != nullptr && view_->is_stopped();
}

void SharedRun::Add(Frame frame, std::optional<double> timestamp,
                    const Rigid3d* guess) {
  const TrackedFrame* const last =
      run_.frames().empty() ? nullptr : &run_.frames().back();
  frame.index = last == nullptr ? 0 : last->index + 1;
  frame.timestamp = timestamp.value_or(
      last == nullptr ? 0.0 : last->timestamp + 1.0 / kDefaultFrameRate);
  if (!std::isfinite(frame.timestamp)) {
    throw InputError("timestamp: is not a finite number of seconds");
  }
  if (last != nullptr && frame.timestamp <= last->timestamp) {
    throw InputError("timestamp: " + std::to_string(frame.timestamp) +
                     " s is not after that of the previous frame; frames must "
                     "be in the order of time");
  }
  if (!std::isfinite(frame.depth_delay)) {
    throw InputError("depth_delay: is not a finite number of seconds");
  }
  run_.Add(PreparedFrame(frame), guess);
  if (view_ == nullptr) return;
  view_->Add(frame, [] {
    ThrowIfInterrupted();
    return false;
  });
}

}  // namespace rgbd_pose
