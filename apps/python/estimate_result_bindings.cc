#include <pybind11/pybind11.h>

#include <string>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/estimate_result.h"
#include "apps/python/pickling.h"
#include "core/estimation/motion_estimate.h"

namespace py = pybind11;

namespace rgbd_pose {
static void EachField(PickledBytes* bytes, EstimateResult& result) {
  MotionEstimate& e = result.estimate;
  (*bytes)(e.status, e.reason, e.cur_from_prev, e.covariance, e.weights,
           e.residual_norms, e.residual_degrees, e.num_used, e.num_inliers,
           e.sigma, e.initial_cost, e.final_cost, e.iterations, e.solve_ms,
           result.is_inlier, result.num_rejected);
}

namespace {

std::string ResultInWords(const EstimateResult& result) {
  const MotionEstimate& e = result.estimate;
  std::string text = std::string("MotionEstimate(") + ToString(e.status);
  if (!e.reason.empty()) text += ": " + e.reason;
  return text + ", " + std::to_string(e.num_inliers) + " of " +
         std::to_string(e.num_used) + " matches agree)";
}

// Throws the module's EstimateError with the status and the reason.
const EstimateResult& RaiseIfFailed(const EstimateResult& self) {
  const MotionEstimate& e = self.estimate;
  if (e.ok()) return self;
  const py::object type =
      py::type::of<EstimateResult>().attr("_error_type").cast<py::object>();
  const py::object error =
      type(std::string(ToString(e.status)) + ": " + e.reason);
  // Refer to the existing Python object instead of copying it.
  error.attr("estimate") = py::cast(&self, py::return_value_policy::reference);
  PyErr_SetObject(type.ptr(), error.ptr());
  throw py::error_already_set();
}

// A getter for a member of MotionEstimate.
template <auto kMember>
auto Field(const EstimateResult& result) {
  return ToPython(result.estimate.*kMember);
}

// The same for a list, as an array without a copy.
template <auto kMember>
py::array List(const py::object& self) {
  return ViewOf(self.cast<const EstimateResult&>().estimate.*kMember, self);
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
  result
      .def_property_readonly(
          "status", &Field<&MotionEstimate::status>,
          "'ok', 'too_few_matches' (fewer than three usable), 'degenerate' "
          "(some\ndirection of motion is not determined), 'not_converged' or\n"
          "'inconsistent' (too few matches agree with one motion)")
      .def_property_readonly("reason", &Field<&MotionEstimate::reason>,
                             "reason of the status; empty if ok")
      .def_property_readonly(
          "ok", [](const EstimateResult& self) { return self.estimate.ok(); },
          "whether the status is 'ok'")
      .def("raise_if_failed", &RaiseIfFailed,
           py::return_value_policy::reference,
           "Raises EstimateError with status and reason unless ok; returns\n"
           "the estimate itself.")
      .def_property_readonly(
          "cur_from_prev", &Field<&MotionEstimate::cur_from_prev>,
          "(4, 4): point_in_cur = cur_from_prev @ point_in_prev (m); the "
          "initial guess\nif the status is 'too_few_matches'")
      .def_property_readonly(
          "covariance", &Field<&MotionEstimate::covariance>,
          "(6, 6), of [omega_x omega_y omega_z Cx Cy Cz]: omega (rad) is a "
          "small\nrotation about the axes of the current camera, R_true = "
          "Exp(omega) R; C (m)\nis the centre of the current camera in the "
          "axes of the previous one. Zero\nif it could not be computed: too "
          "few matches, degenerate, or no usable step.")
      .def_property_readonly("weights", &List<&MotionEstimate::weights>,
                             "(N,) float64: robust weights in [0, 1]")
      .def_property_readonly(
          "inliers",
          [](const py::object& self) {
            const auto& e = self.cast<const EstimateResult&>();
            return ViewOf(e.is_inlier, self).view("bool");
          },
          "(N,) bool: whether the match agrees with the motion within 99 % of\n"
          "the noise's distribution")
      .def_property_readonly(
          "residual_norms", &List<&MotionEstimate::residual_norms>,
          "(N,) float64: norm of the whitened residual, in sigmas of the noise")
      .def_property_readonly(
          "residual_degrees", &List<&MotionEstimate::residual_degrees>,
          "(N,) int32: independent measurements in the residual; the norm for\n"
          "correct matches has a chi distribution with as many degrees")
      .def_property_readonly("num_used", &Field<&MotionEstimate::num_used>,
                             "matches that at least one cost could use")
      .def_property_readonly("num_inliers",
                             &Field<&MotionEstimate::num_inliers>,
                             "number of inliers among these")
      .def_readonly("num_rejected", &EstimateResult::num_rejected,
                    "ignored rows: not finite, or with a negative depth")
      .def_property_readonly("sigma", &Field<&MotionEstimate::sigma>,
                             "robust spread of the whitened residuals, "
                             "ideally 1")
      .def_property_readonly("initial_cost",
                             &Field<&MotionEstimate::initial_cost>,
                             "robust cost at the initial guess")
      .def_property_readonly("final_cost", &Field<&MotionEstimate::final_cost>,
                             "robust cost at the estimated motion")
      .def_property_readonly("iterations", &Field<&MotionEstimate::iterations>,
                             "solver iterations of all stages")
      .def_property_readonly("solve_ms", &Field<&MotionEstimate::solve_ms>,
                             "solver time, ms")
      .def("__repr__", &ResultInWords)
      .def(Pickled<EstimateResult>());
}

}  // namespace rgbd_pose
