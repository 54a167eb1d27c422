#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <string>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/pickling.h"
#include "apps/python/released_gil.h"
#include "apps/results/calibration_output.h"
#include "apps/shell/program.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/calibration/calibration_run.h"
#include "frontend/files/camera_file.h"
#include "frontend/files/depth_noise_file.h"

namespace py = pybind11;

namespace rgbd_pose {
static void EachField(PickledBytes* bytes, HeldOutResidual& residual) {
  (*bytes)(residual.u, residual.v, residual.before, residual.after,
           residual.flow);
}

static void EachField(PickledBytes* bytes, DepthNoiseFit& noise) {
  (*bytes)(noise.model, noise.constant_sigma, noise.quadratic_sigma,
           noise.scatter, noise.samples, noise.in_old_sigmas);
}

namespace {

// A result, and the file whose layout the new camera file has.
struct Calibration : CalibrationResult {
  std::string like;
};

void EachField(PickledBytes* bytes, Calibration& r) {
  (*bytes)(r.like, r.parameters, r.is_better, r.is_accepted, r.reason, r.camera,
           r.found, r.keyframes, r.pairs, r.held_out_pairs, r.landmarks,
           r.views, r.cost_before, r.cost_after, r.gain_sigmas, r.unseen_before,
           r.unseen_after, r.unseen_sigmas, r.pixel_before, r.pixel_after,
           r.depth_before, r.depth_after, r.residuals, r.noise, r.noise_before,
           r.noise_found, r.truth_before, r.truth_after, r.halves,
           r.halves_spread, r.displacement_px, r.passes, r.scale_from);
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
  RecordingCalibration all;
  {
    const ReleasedGil no_gil;
    all = CalibrateRecording(
        sequence, CalibrationOdometry(), CalibrationSlam(), settings,
        NumThreads(threads), [](int, int, int) { ThrowIfInterrupted(); },
        [](int, int) { ThrowIfInterrupted(); });
  }
  for (const std::string& line : all.left_out) WarnUser(line);
  if (!all.stopped.empty()) {
    WarnUser("stopped early (" + all.stopped +
             "); the result is of the frames before");
  }
  return {all.result, sequence.camera};
}

std::map<std::string, CalibratedParameter> Parameters(const Calibration& self) {
  std::map<std::string, CalibratedParameter> all;
  for (int k = 0; k < kCalibrationSize; ++k) {
    all[kCalibrationParameters[k].name] = self.parameters[k];
  }
  return all;
}

void BindCalibratedParameter(py::module_* module) {
  py::class_<CalibratedParameter> parameter(
      *module, "CalibratedParameter",
      "The result for one parameter of a camera.");
  const auto property = PropertiesOf(&parameter);
  property("status", &CalibratedParameter::status,
           "fixed, not determined or determined");
  property("before", &CalibratedParameter::before, "value of the first camera");
  property("found", &CalibratedParameter::found,
           "value estimated from the recording");
  property("sigma", &CalibratedParameter::sigma,
           "standard deviation of the estimate");
  parameter.def("__repr__", [](const CalibratedParameter& self) {
    return Format("CalibratedParameter(%s: %.6g to %.6g +- %.2g)",
                  ToString(self.status), self.before, self.found, self.sigma);
  });
  parameter.def(Pickled<CalibratedParameter>());
}

void BindResult(py::module_* module) {
  py::class_<Calibration> calibration(*module, "Calibration",
                                      "The result of calibrate().");
  const auto property = PropertiesOf(&calibration);
  property("accepted", &CalibrationResult::is_accepted,
           "whether the camera found is better than the first one");
  property("reason", &CalibrationResult::reason,
           "why it is not; empty if it is");
  property(
      "camera", &CalibrationResult::camera,
      "the camera to use: the camera found, or the first one if not accepted");
  property("parameters", &Parameters,
           "CalibratedParameter by name, such as fx");
  property(
      "depth_noise",
      [](const Calibration& self) -> py::object {
        if (!self.noise.has_value()) return py::none();
        const DepthNoiseModel& model = self.noise->model;
        return py::make_tuple(model.constant, model.quadratic);
      },
      "(a, b) of sigma(z) = a + b z^2, m; None: too few depths");
  property(
      "summary",
      [](const Calibration& self) { return FormatCalibrationSummary(self); },
      "the result as text, as rgbd_calibrate prints it");
  calibration.def(
      "save_camera",
      [](const Calibration& self, const py::object& path) {
        WriteFileAtomically(PathFrom(path),
                            FormatCameraFile(self.camera, self.like));
      },
      "Writes the camera to use, in the layout of the first one's file.",
      py::arg("path"));
  calibration.def(
      "save_depth_noise",
      [](const Calibration& self, const py::object& path) {
        if (!self.noise.has_value()) {
          throw InputError("too few depths to estimate the depth noise");
        }
        WriteFileAtomically(PathFrom(path),
                            FormatDepthNoiseFile(self.noise->model));
      },
      "Writes a file for the argument depth_noise. Raises InputError if "
      "depth_noise is\nNone.",
      py::arg("path"));
  calibration.def("__repr__", [](const Calibration& self) {
    return "Calibration(" + (self.is_accepted ? "accepted" : self.reason) + ")";
  });
  calibration.def(Pickled<Calibration>());
}

}  // namespace

void BindCalibration(py::module_* module) {
  BindCalibratedParameter(module);
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
