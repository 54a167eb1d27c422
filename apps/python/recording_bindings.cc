// Recordings of RGB-D cameras.

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/frame_images.h"
#include "apps/python/pickling.h"
#include "apps/python/released_gil.h"
#include "frontend/files/camera_file.h"
#include "frontend/sources/frame_range.h"
#include "frontend/sources/open_source.h"
#include "frontend/sources/tum_dataset.h"

namespace py = pybind11;

namespace rgbd_pose {
static void EachField(PickledBytes* bytes, Frame& f) {
  (*bytes)(f.index, f.timestamp, f.depth_delay, f.gray, f.depth, f.depth_scale,
           f.color_shutter, f.depth_shutter);
}

namespace {

std::unique_ptr<TumDataset> OpenTumDataset(const py::object& folder,
                                           const RgbdCamera& camera,
                                           const py::object& associations) {
  SourceOptions options;
  options.path = PathFrom(folder);
  if (!associations.is_none()) {
    options.associations_file = PathFrom(associations);
  }
  options.camera = camera;
  return std::make_unique<TumDataset>(options);
}

Frame ReadFrame(const TumDataset& dataset, int index) {
  if (index < 0) index += dataset.size();
  if (index < 0 || index >= dataset.size()) {
    throw py::index_error("the dataset has " + std::to_string(dataset.size()) +
                          " frames");
  }
  const ReleasedGil no_gil;
  return dataset.Read(index);
}

// A recording of any kind. Each iteration reads it from the start.
class Recording {
 public:
  Recording(SourceOptions options, std::string source, const FrameRange& range)
      : options_(std::move(options)),
        name_(std::move(source)),
        range_(range),
        source_(Open()) {}

  const FrameSource& source() const { return *source_; }

  // The source at its start.
  std::shared_ptr<FrameSource> Begin() {
    if (is_used_) source_ = Open();
    is_used_ = true;
    return source_;
  }

 private:
  std::shared_ptr<FrameSource> Open() const {
    return PartOf(OpenSource(name_, options_), range_);
  }

  SourceOptions options_;
  std::string name_;
  FrameRange range_;
  std::shared_ptr<FrameSource> source_;
  bool is_used_ = false;
};

struct RecordingIterator {
  std::shared_ptr<FrameSource> source;
};

std::unique_ptr<Recording> OpenRecording(
    const py::object& path, const py::object& camera, const std::string& source,
    const std::string& frames, const py::object& associations,
    const std::string& depth_camera, double depth_scale,
    const std::vector<std::string>& topics) {
  SourceOptions options;
  options.path = PathFrom(path);
  if (!associations.is_none()) {
    options.associations_file = PathFrom(associations);
  }
  if (py::isinstance<RgbdCamera>(camera)) {
    options.camera = camera.cast<RgbdCamera>();
  } else if (!camera.is_none()) {
    options.camera = ResolveCameraSetup(PathFrom(camera), depth_camera);
  }
  options.depth_scale = depth_scale;
  options.topics = topics;
  return std::make_unique<Recording>(std::move(options), source,
                                     ParseFrameRange(frames));
}

Frame NextFrame(RecordingIterator* self) {
  std::optional<Frame> frame;
  {
    const ReleasedGil no_gil;
    const std::optional<RgbdFrame> next = self->source->Next();
    if (next.has_value()) frame = next->read();
  }
  if (!frame.has_value()) throw py::stop_iteration();
  return *frame;
}

void BindFrame(py::module_* module) {
  py::class_<Frame>(*module, "Frame", "One RGB-D image pair of a sequence.")
      .def_readonly("index", &Frame::index, "index in its dataset, from 0")
      .def_readonly("timestamp", &Frame::timestamp, "of the colour image, s")
      .def_readonly("depth_delay", &Frame::depth_delay,
                    "of the depth image, s after the colour image")
      .def_property_readonly(
          "gray",
          [](const py::object& self) {
            return ArrayOfImage<uint8_t>(self.cast<const Frame&>().gray, self);
          },
          "(height, width) uint8")
      .def_property_readonly(
          "depth",
          [](const py::object& self) {
            return ArrayOfImage<uint16_t>(self.cast<const Frame&>().depth,
                                          self);
          },
          "(height, width) uint16, raw units; 0 and 65535: none")
      .def(Pickled<Frame>());
}

void BindTumDataset(py::module_* module) {
  py::class_<TumDataset>(*module, "TumDataset", R"(
A sequence in the layout of the TUM RGB-D benchmark, as a sequence of Frame.

folder: with rgb.txt and depth.txt, which are paired by time.
associations: file that pairs colour and depth images instead.

Raises InputError (file:line) for unreadable input; images are read when they
are accessed, with the GIL released.)")
      .def(py::init(&OpenTumDataset), "Raises InputError for unreadable input.",
           py::arg("folder"), py::arg("camera").none(false),
           py::arg("associations") = py::none())
      .def("__len__", &TumDataset::size)
      .def("__getitem__", &ReadFrame, py::arg("index"))
      .def("__iter__",
           [](const py::object& self) {
             return py::reinterpret_steal<py::iterator>(
                 PySeqIter_New(self.ptr()));
           })
      .def_property_readonly(
          "camera", [](const TumDataset& self) { return self.camera(); },
          "camera of all frames");
}

void BindAnyRecording(py::module_* module) {
  py::class_<RecordingIterator>(*module, "_RecordingIterator")
      .def("__iter__", [](const py::object& self) { return self; })
      .def("__next__", &NextFrame);
  py::class_<Recording>(*module, "Recording", R"(
A recording of any supported kind: `for frame in recording` yields each Frame,
decoded when it is accessed, with the GIL released. Each loop reads it again.

path: a folder or a file.
camera: a Camera, a preset or a calibration file; None: the camera stored in the
    recording.
source: its kind; "auto": detected.
frames: part of it, such as "0-99", "100-400:2" or "2.5s-10s"; "": all.
associations: file that pairs colour and depth images (TUM).
depth_camera: the camera of a Kalibr file that took the depth images, which are
    registered to colour then.
depth_scale: raw depth units per metre; 0: from the camera or the recording.
topics: of a bag: colour, depth[, camera_info]; empty: chosen by their types.

Raises InputError for unreadable input.)")
      .def(py::init(&OpenRecording), "Raises InputError for unreadable input.",
           py::arg("path"), py::arg("camera") = py::none(), py::kw_only(),
           py::arg("source") = "auto", py::arg("frames") = "",
           py::arg("associations") = py::none(), py::arg("depth_camera") = "",
           py::arg("depth_scale") = 0.0, py::arg("topics") = py::tuple())
      .def("__iter__",
           [](Recording* self) { return RecordingIterator{self->Begin()}; })
      .def_property_readonly(
          "camera",
          [](const Recording& self) { return self.source().camera(); },
          "camera of all frames")
      .def_property_readonly(
          "timestamps",
          [](const Recording& self) {
            return py::array(py::cast(self.source().timestamps()));
          },
          "(N,) of all frames, s; empty if they are not known in advance")
      .def(
          "ground_truth",
          [](const Recording& self) {
            return ArraysFromTrajectory(self.source().ground_truth());
          },
          "(timestamps (N,), world_from_cam (N, 4, 4)) of the recording; for a "
          "bag what has been read so far");
}

}  // namespace

void BindRecording(py::module_* module) {
  BindFrame(module);
  BindTumDataset(module);
  BindAnyRecording(module);
}

}  // namespace rgbd_pose
