// Recordings of RGB-D cameras.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/pickling.h"
#include "apps/python/recording.h"
#include "apps/python/released_gil.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/files/camera_file.h"
#include "frontend/settings/sequence.h"
#include "frontend/sources/frame_range.h"
#include "frontend/sources/open_source.h"

namespace py = pybind11;

namespace rgbd_pose {
static void EachField(PickledBytes* bytes, Frame& f) {
  (*bytes)(f.index, f.timestamp, f.depth_delay, f.gray, f.depth, f.depth_scale,
           f.color_shutter, f.depth_shutter);
}

namespace {

int LengthOf(const Recording& recording) {
  const size_t frames = recording.timestamps().size();
  if (frames > 0) return static_cast<int>(frames);
  throw py::type_error(
      "the number of frames of this recording is not known in advance; loop "
      "over it");
}

// `index` may count from the end.
Frame FrameAt(Recording* recording, int index) {
  const int frames = LengthOf(*recording);
  const int from_start = index < 0 ? index + frames : index;
  if (from_start < 0 || from_start >= frames) {
    throw py::index_error(
        Format("frame %d: there are %d frames", index, frames));
  }
  const ReleasedGil no_gil;
  return recording->Read(from_start);
}

// Frames of a part in their order: reading backwards would decode each again.
Recording SliceOf(const Recording& recording, const py::slice& slice) {
  py::ssize_t first = 0, stop = 0, step = 0, frames = 0;
  if (!slice.compute(LengthOf(recording), &first, &stop, &step, &frames)) {
    throw py::error_already_set();
  }
  if (step < 1) throw py::index_error("frames are read forward: step >= 1");
  if (frames == 0) throw py::index_error("this part has no frames");
  FrameRange range;
  range.first = static_cast<int>(first);
  range.last = static_cast<int>(stop) - 1;
  range.step = static_cast<int>(step);
  return Recording(recording.path(),
                   [open = recording.open(), range](bool keep_color) {
                     return PartOf(open(keep_color), range);
                   });
}

Recording OpenRecording(const py::object& path, const py::object& camera,
                        const std::string& source, const std::string& frames,
                        const py::object& associations,
                        const std::string& depth_camera, double depth_scale,
                        const std::vector<std::string>& topics,
                        const py::object& imu) {
  SourceOptions options;
  options.path = PathFrom(path);
  if (!associations.is_none()) {
    options.associations_file = PathFrom(associations);
  }
  const bool is_file = !camera.is_none() && !py::isinstance<RgbdCamera>(camera);
  if (!is_file && !depth_camera.empty()) {
    throw InputError("depth_camera '" + depth_camera +
                     "': needs a Kalibr file with this camera as camera");
  }
  if (is_file) {
    options.camera = ResolveCameraSetup(PathFrom(camera), depth_camera);
    WarnUser(options.camera->remark);
  } else if (!camera.is_none()) {
    options.camera = camera.cast<RgbdCamera>();
  }
  options.depth_scale = depth_scale;
  options.topics = topics;
  if (!imu.is_none()) options.imu = PathFrom(imu);
  Recording recording(
      options.path,
      [options, source, range = ParseFrameRange(frames)](bool keep_color) {
        SourceOptions with_color = options;
        with_color.keep_color = keep_color;
        return PartOf(OpenSource(source, with_color), range);
      });
  for (const std::string& line : DroppedFrames(recording.source(), {})) {
    WarnUser(line);
  }
  return recording;
}

std::string RecordingInWords(const Recording& recording) {
  const Camera& camera = recording.source().camera().camera;
  const size_t frames = recording.timestamps().size();
  const std::string length =
      frames == 0 ? "" : ", " + std::to_string(frames) + " frames";
  return "Recording(" + py::repr(PathTo(recording.path())).cast<std::string>() +
         length + Format(", %d x %d)", camera.width, camera.height);
}

py::array ImuSamplesOf(const Recording& recording) {
  std::vector<ImuSample> samples;
  {
    const ReleasedGil no_gil;
    samples = recording.ReadImu();
  }
  RowMajorMatrix rows(samples.size(), 7);
  for (size_t i = 0; i < samples.size(); ++i) {
    rows.row(i) << samples[i].stamp, samples[i].gyro.transpose(),
        samples[i].accel.transpose();
  }
  return ArrayFromMatrix(rows);
}

py::object ImuCalibrationOf(const Recording& recording) {
  const std::optional<ImuSensor> sensor = recording.source().imu();
  if (!sensor.has_value()) return py::none();
  const auto& [cam_from_imu, delay, noise] = sensor->calibration;
  py::dict result;
  result["has_gyro"] = sensor->has_gyro;
  result["cam_from_imu"] = py::none();
  if (cam_from_imu) result["cam_from_imu"] = ToPython(*cam_from_imu);
  result["delay"] = delay;
  result["noise"] = py::none();
  if (noise.has_value()) {
    py::dict values;
    values["gyro"] = noise->gyro_density;
    values["accel"] = noise->accel_density;
    values["gyro_walk"] = noise->gyro_walk;
    values["accel_walk"] = noise->accel_walk;
    result["noise"] = values;
  }
  return result;
}

// A getter for an image: a read-only view, which keeps the frame alive.
template <typename T, auto kImage>
py::array ArrayOf(const py::object& frame) {
  const cv::Mat& image = frame.cast<const Frame&>().*kImage;
  return ReadOnly(py::array(py::dtype::of<T>(), {image.rows, image.cols},
                            {image.step[0], image.step[1]}, image.data, frame));
}

void BindFrame(py::module_* module) {
  py::class_<Frame> frame(*module, "Frame",
                          "One RGB-D image pair of a sequence.");
  const auto property = PropertiesOf(&frame);
  property("index", &Frame::index, "index in its dataset, from 0");
  property("timestamp", &Frame::timestamp, "of the colour image, s");
  property("depth_delay", &Frame::depth_delay,
           "of the depth image, s after the colour image");
  property("gray", &ArrayOf<uint8_t, &Frame::gray>, "(height, width) uint8");
  property("depth", &ArrayOf<uint16_t, &Frame::depth>,
           "(height, width) uint16, raw units; 0 and 65535: none");
  frame
      .def("__repr__",
           [](const Frame& self) {
             return Format("Frame(%d at %.6f s, %d x %d)", self.index,
                           self.timestamp, self.gray.cols, self.gray.rows);
           })
      .def(Pickled<Frame>());
}

// A loop over a recording. Several threads may share it: Python's own iterator
// of a function fails if two of them come to the end at once.
struct FrameIterator {
  std::shared_ptr<FrameSource> source;  // other threads may still read of it
  std::shared_ptr<std::mutex> mutex;
  std::vector<std::string> said;  // to users, when it was opened
  bool is_at_end = false;

  // Empty at the end, where `news` gets what else is to be said, once.
  std::optional<Frame> Next(std::vector<std::string>* news) {
    const ReleasedGil no_gil;
    std::optional<RgbdFrame> frame;
    {
      const std::lock_guard<std::mutex> lock(*mutex);
      if (!is_at_end) {
        frame = source->Next();
        is_at_end = !frame.has_value();
        if (is_at_end) *news = News();
      }
    }
    return frame ? std::make_optional(frame->read()) : std::nullopt;
  }

  // What reading has shown: a bag does not know its images before.
  std::vector<std::string> News() const {
    std::vector<std::string> lines;
    for (std::string& line : DroppedFrames(*source, {})) {
      const bool is_new = std::count(said.begin(), said.end(), line) == 0;
      if (is_new) lines.push_back(std::move(line));
    }
    return lines;
  }
};

void BindFrameIterator(py::module_* module) {
  py::class_<FrameIterator>(*module, "_FrameIterator")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", [](FrameIterator* self) {
        std::vector<std::string> news;
        std::optional<Frame> frame = self->Next(&news);
        if (frame.has_value()) return *std::move(frame);
        for (const std::string& line : news) WarnUser(line);
        throw py::stop_iteration();
      });
}

void BindAnyRecording(py::module_* module) {
  py::class_<Recording> recording(*module, "Recording", R"(
A recording of any kind that the programs read: `for frame in recording` gives
one Frame after the other; each is decoded on access, with the GIL released.
Each loop reads the recording again. If the frames are known in advance (not
those of bags), len(recording) is their number, recording[i] reads one, and
recording[100:400:2] is the recording of a part.

path: a folder or a file.
camera: a Camera, a preset or a calibration file; None: the camera stored in the
    recording.
source: its kind; "auto": detected.
frames: part of it, such as "0-99", "100-400:2" or "2.5s-10s"; "": all.
associations: file that pairs colour and depth images (TUM).
depth_camera: the camera of a Kalibr file that took the depth images, which are
    registered to colour then.
depth_scale: raw depth units per metre; 0: from the camera or the recording.
topics: of a bag: colour, depth[, camera_info], inertial sensor; those that are
    not given are chosen by their types.
imu: file that says mounting, delay or noise of the inertial sensor (Kalibr's);
    None: what the camera file and the recording say; "none": its samples are
    not read.

Warns of what was chosen or left out on opening, such as a frame rate that the
recording does not specify. Raises InputError for unreadable input.)");
  recording.def(py::init(&OpenRecording),
                "Raises InputError for unreadable input.", py::arg("path"),
                py::arg("camera") = py::none(), py::kw_only(),
                py::arg("source") = "auto", py::arg("frames") = "",
                py::arg("associations") = py::none(),
                py::arg("depth_camera") = "", py::arg("depth_scale") = 0.0,
                py::arg("topics") = py::tuple(), py::arg("imu") = py::none());
  recording.def("__iter__", [](Recording* self) {
    const std::shared_ptr<FrameSource> source = self->Begin();
    return FrameIterator{source, self->mutex(), DroppedFrames(*source, {})};
  });
  recording.def("__repr__", &RecordingInWords);
  recording.def("__len__", &LengthOf);
  // Not by the length, which may be unknown.
  recording.def("__bool__", [](const Recording&) { return true; });
  recording.def("__getitem__", &FrameAt, py::arg("index"));
  recording.def("__getitem__", &SliceOf, py::arg("index"));
  const auto property = PropertiesOf(&recording);
  property(
      "camera", [](const Recording& self) { return self.source().camera(); },
      "camera of all frames");
  property(
      "timestamps",
      [](const Recording& self) {
        return ReadOnly(py::array(py::cast(self.timestamps())));
      },
      "(N,) of all frames, s; empty if they are not known in advance");
  recording.def(
      "ground_truth",
      [](const Recording& self) {
        const std::lock_guard<std::mutex> lock(*self.mutex());
        return ArraysFromTrajectory(self.source().ground_truth());
      },
      "(timestamps (N,), world_from_cam (N, 4, 4)) of the recording; for a bag "
      "what has been read so far");
  recording.def("imu", &ImuSamplesOf,
                "(N, 7) of the inertial sensor, in its axes and with its "
                "stamps: stamp (s), angular velocity (rad/s), acceleration as "
                "it is measured (m/s^2); N = 0 without a sensor. Reads the "
                "whole recording without its images.");
  recording.def("imu_calibration", &ImuCalibrationOf,
                "dict of what is known of the inertial sensor, None without "
                "one: has_gyro, cam_from_imu (4, 4) or None, delay (s, of its "
                "stamps after the camera's) or None, noise or None: dict of "
                "densities gyro, accel (rad/s, m/s^2 per sqrt(Hz)) and walks "
                "gyro_walk, accel_walk.");
}

}  // namespace

void BindRecording(py::module_* module) {
  BindFrame(module);
  BindFrameIterator(module);
  BindAnyRecording(module);
}

}  // namespace rgbd_pose
