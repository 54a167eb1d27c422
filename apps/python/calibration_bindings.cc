#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apps/calibration/calibration_run.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/pickling.h"
#include "apps/python/released_gil.h"
#include "apps/results/calibration_output.h"
#include "apps/shell/program.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/depth_noise_file.h"

namespace py = pybind11;

namespace rgbd_pose {
static void EachField(PickledBytes* bytes, CalibratedParameter& parameter) {
  (*bytes)(parameter);
}

static void EachField(PickledBytes* bytes, HeldOutResidual& residual) {
  (*bytes)(residual.u, residual.v, residual.before, residual.after);
}

static void EachField(PickledBytes* bytes, DepthNoiseFit& noise) {
  DepthNoiseModel& model = noise.model;
  (*bytes)(model.name, model.constant, model.quadratic, model.centre,
           model.mean_share, noise.constant_sigma, noise.quadratic_sigma,
           noise.scatter, noise.samples, noise.in_old_sigmas);
}

namespace {

// A result, and the file whose layout the new camera file has.
struct Calibration {
  CalibrationResult result;
  std::string like;
};

void EachField(PickledBytes* bytes, Calibration& calibration) {
  CalibrationResult& r = calibration.result;
  (*bytes)(calibration.like, r.parameters, r.is_accepted, r.reason, r.camera,
           r.found, r.keyframes, r.pairs, r.held_out_pairs, r.landmarks,
           r.views, r.cost_before, r.cost_after, r.gain_sigmas, r.pixel_before,
           r.pixel_after, r.depth_before, r.depth_after, r.residuals, r.noise,
           r.truth_before, r.truth_after, r.halves, r.halves_spread,
           r.displacement_px, r.passes, r.scale_from);
}

// Called after each frame without the GIL. Ctrl-C interrupts a calibration.
void ThrowIfInterrupted() {
  const py::gil_scoped_acquire gil;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

Calibration CalibrateFile(const py::object& path, const py::object& camera,
                          const std::string& source, const std::string& frames,
                          const py::object& associations,
                          const std::string& depth_camera, double depth_scale,
                          const py::object& groundtruth,
                          const std::string& known_length,
                          const std::string& fix, int max_passes, int max_views,
                          int threads) {
  SequenceSettings sequence;
  sequence.dataset = PathFrom(path);
  if (!camera.is_none()) sequence.camera = PathFrom(camera);
  sequence.source = source;
  sequence.frames = frames;
  if (!associations.is_none()) sequence.associations = PathFrom(associations);
  sequence.depth_camera = depth_camera;
  sequence.depth_scale = depth_scale;
  if (!groundtruth.is_none()) sequence.groundtruth = PathFrom(groundtruth);
  CalibrationSettings settings;
  settings.known_length = known_length;
  settings.fix = fix;
  settings.max_passes = max_passes;
  settings.max_views = max_views;
  const ReleasedGil no_gil;
  return {CalibrateRecording(sequence, CalibrationOdometry(), CalibrationSlam(),
                             settings, NumThreads(threads),
                             [](int, int, int) { ThrowIfInterrupted(); })
              .result,
          sequence.camera};
}

std::map<std::string, CalibratedParameter> Parameters(const Calibration& self) {
  std::map<std::string, CalibratedParameter> all;
  for (int k = 0; k < kCalibrationSize; ++k) {
    all[kCalibrationParameters[k].name] = self.result.parameters[k];
  }
  return all;
}

// A getter for a member of the result.
template <auto kMember>
auto Found(const Calibration& self) {
  return self.result.*kMember;
}

void BindResult(py::module_* module) {
  py::class_<CalibratedParameter>(*module, "CalibratedParameter",
                                  "The result for one parameter of a camera.")
      .def_property_readonly(
          "status",
          [](const CalibratedParameter& self) { return ToString(self.status); },
          "fixed, not determined or determined")
      .def_readonly("before", &CalibratedParameter::before,
                    "value of the first camera")
      .def_readonly("found", &CalibratedParameter::found,
                    "value estimated from the recording")
      .def_readonly("sigma", &CalibratedParameter::sigma,
                    "standard deviation of the estimate")
      .def(Pickled<CalibratedParameter>());
  py::class_<Calibration>(*module, "Calibration", "The result of calibrate().")
      .def_property_readonly(
          "accepted", &Found<&CalibrationResult::is_accepted>,
          "whether the camera found is better than the first one")
      .def_property_readonly("reason", &Found<&CalibrationResult::reason>,
                             "why it is not; empty if it is")
      .def_property_readonly(
          "camera", &Found<&CalibrationResult::camera>,
          "the camera to use: the camera found, or the first one if not "
          "accepted")
      .def_property_readonly("parameters", &Parameters,
                             "CalibratedParameter by name, such as fx")
      .def_property_readonly(
          "depth_noise",
          [](const Calibration& self) -> py::object {
            if (!self.result.noise.has_value()) return py::none();
            const DepthNoiseModel& model = self.result.noise->model;
            return py::make_tuple(model.constant, model.quadratic);
          },
          "(a, b) of sigma(z) = a + b z^2, m; None: too few depths")
      .def_property_readonly(
          "summary",
          [](const Calibration& self) {
            return FormatCalibrationSummary(self.result);
          },
          "the result as text, as rgbd_calibrate prints it")
      .def(
          "save_camera",
          [](const Calibration& self, const py::object& path) {
            WriteFileAtomically(
                PathFrom(path),
                FormatCameraFile(self.result.camera, self.like));
          },
          "Writes the camera to use, in the layout of the first one's file.",
          py::arg("path"))
      .def(
          "save_depth_noise",
          [](const Calibration& self, const py::object& path) {
            if (!self.result.noise.has_value()) {
              throw InputError("too few depths to estimate the depth noise");
            }
            WriteFileAtomically(PathFrom(path),
                                FormatDepthNoiseFile(self.result.noise->model));
          },
          "Writes a file for the argument depth_noise. Raises InputError if "
          "depth_noise is\nNone.",
          py::arg("path"))
      .def(Pickled<Calibration>());
}

}  // namespace

void BindCalibration(py::module_* module) {
  BindResult(module);
  module->def("calibrate", &CalibrateFile, R"(
Calibrates a camera from its own recording, as rgbd_calibrate does: lens, depth,
timing, registration. Takes about as long as the recording; the GIL is released.

path, camera, source, frames, associations, depth_camera, depth_scale: as in
    Recording; the camera is a preset or a file.
groundtruth: trajectory (TUM text) that determines the depth scale; "none": do
    not use that of the recording either.
known_length: "T0,T1,METRES", distance of the camera positions at two times (s).
fix: names of parameters to keep, separated by commas.
max_passes: maximum number of times that the recording is mapped.
max_views: approximate number of landmark views; the time grows with it.
threads: 0: one for each core.

Raises InputError for unreadable input and invalid arguments.)",
              py::arg("path"), py::arg("camera") = py::none(), py::kw_only(),
              py::arg("source") = "auto", py::arg("frames") = "",
              py::arg("associations") = py::none(),
              py::arg("depth_camera") = "", py::arg("depth_scale") = 0.0,
              py::arg("groundtruth") = py::none(), py::arg("known_length") = "",
              py::arg("fix") = "",
              py::arg("max_passes") = CalibrationSettings().max_passes,
              py::arg("max_views") = CalibrationSettings().max_views,
              py::arg("threads") = 0);
}

}  // namespace rgbd_pose
