#include <pybind11/pybind11.h>

#include <string>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/estimate_result.h"
#include "apps/python/pickling.h"
#include "core/estimation/motion_estimate.h"

namespace py = pybind11;

namespace rgbd_pose {
static void EachField(PickledBytes* bytes, EstimateResult& e) {
  (*bytes)(e.status, e.reason, e.cur_from_prev, e.covariance, e.weights,
           e.residual_norms, e.residual_degrees, e.num_used, e.num_inliers,
           e.sigma, e.initial_cost, e.final_cost, e.iterations, e.solve_ms,
           e.inliers, e.num_rejected);
}

namespace {

std::string ResultInWords(const EstimateResult& e) {
  std::string text = std::string("MotionEstimate(") + ToString(e.status);
  if (!e.reason.empty()) text += ": " + e.reason;
  return text + ", " + std::to_string(e.num_inliers) + " of " +
         std::to_string(e.num_used) + " matches agree)";
}

// Throws the module's EstimateError with the status and the reason.
const EstimateResult& RaiseIfFailed(const EstimateResult& self) {
  if (self.ok()) return self;
  const py::object type =
      py::type::of<EstimateResult>().attr("_error_type").cast<py::object>();
  const py::object error =
      type(std::string(ToString(self.status)) + ": " + self.reason);
  // Refer to the existing Python object instead of copying it.
  error.attr("estimate") = py::cast(&self, py::return_value_policy::reference);
  PyErr_SetObject(type.ptr(), error.ptr());
  throw py::error_already_set();
}

}  // namespace

void BindEstimateResult(py::module_* module) {
  module->attr("EstimateError") =
      py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
          "rgbd_pose.EstimateError",
          "A motion could not be estimated: status and reason. `estimate` is "
          "the\nMotionEstimate.",
          PyExc_RuntimeError, nullptr));
  py::class_<EstimateResult> result(*module, "MotionEstimate", R"(
The estimated motion between two frames and its quality. Arrays are read-only;
those of N entries have one for each input row, 0 or False for rows that no cost
could use.)");
  result.attr("_error_type") = module->attr("EstimateError");
  const auto property = PropertiesOf(&result);
  property("status", &MotionEstimate::status,
           "'ok', 'too_few_matches' (fewer than three usable), 'degenerate' "
           "(some\ndirection of motion is not determined), 'not_converged' or\n"
           "'inconsistent' (too few matches agree with one motion)");
  property("reason", &MotionEstimate::reason,
           "reason of the status; empty if ok");
  property(
      "ok", [](const EstimateResult& self) { return self.ok(); },
      "whether the status is 'ok'");
  result.def("raise_if_failed", &RaiseIfFailed,
             py::return_value_policy::reference,
             "Raises EstimateError with status and reason unless ok; returns\n"
             "the estimate itself.");
  property("cur_from_prev", &MotionEstimate::cur_from_prev,
           "(4, 4): point_in_cur = cur_from_prev @ point_in_prev (m); the "
           "initial guess\nif the status is 'too_few_matches'");
  property("covariance", &MotionEstimate::covariance,
           "(6, 6), of [omega_x omega_y omega_z Cx Cy Cz]: omega (rad) is a "
           "small\nrotation about the axes of the current camera, R_true = "
           "Exp(omega) R; C (m)\nis the centre of the current camera in the "
           "axes of the previous one. Zero\nif it could not be computed: too "
           "few matches, degenerate, or no usable step.");
  property("weights", &ViewOf<EstimateResult, &MotionEstimate::weights>,
           "(N,) float64: robust weights in [0, 1]");
  property(
      "inliers",
      [](const py::object& self) {
        return ViewOf<EstimateResult, &EstimateResult::inliers>(self).view(
            "bool");
      },
      "(N,) bool: whether the match agrees with the motion within 99 % of\n"
      "the noise's distribution");
  property(
      "residual_norms",
      &ViewOf<EstimateResult, &MotionEstimate::residual_norms>,
      "(N,) float64: norm of the whitened residual, in sigmas of the noise");
  property("residual_degrees",
           &ViewOf<EstimateResult, &MotionEstimate::residual_degrees>,
           "(N,) int32: independent measurements in the residual; the norm "
           "for\ncorrect matches has a chi distribution with as many degrees");
  property("num_used", &MotionEstimate::num_used,
           "matches that at least one cost could use");
  property("num_inliers", &MotionEstimate::num_inliers,
           "number of inliers among these");
  property("num_rejected", &EstimateResult::num_rejected,
           "ignored rows: not finite, or with an invalid depth");
  property("sigma", &MotionEstimate::sigma,
           "robust spread of the whitened residuals, ideally 1");
  property("initial_cost", &MotionEstimate::initial_cost,
           "robust cost at the initial guess");
  property("final_cost", &MotionEstimate::final_cost,
           "robust cost at the estimated motion");
  property("iterations", &MotionEstimate::iterations,
           "solver iterations of all stages");
  property("solve_ms", &MotionEstimate::solve_ms, "solver time, ms");
  result.def("__repr__", &ResultInWords).def(Pickled<EstimateResult>());
}

}  // namespace rgbd_pose
