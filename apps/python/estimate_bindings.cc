#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/factor_arguments.h"
#include "apps/python/matches.h"
#include "apps/python/pickling.h"
#include "apps/python/released_gil.h"
#include "apps/python/setting_arguments.h"
#include "apps/shell/program.h"
#include "core/estimation/correspondences.h"
#include "core/estimation/estimator.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/camera.h"
#include "core/initial_guess/initial_guess.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "frontend/settings/settings.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// An estimate whose lists have an entry for each input row, a match or not.
struct EstimateResult : MotionEstimate {
  std::vector<uint8_t> inliers;  // is_inlier; an array needs bytes
  size_t num_rejected = 0;
};

void EachField(PickledBytes* bytes, EstimateResult& e) {
  (*bytes)(e.status, e.reason, e.cur_from_prev, e.covariance, e.weights,
           e.residual_norms, e.residual_degrees, e.num_used, e.num_inliers,
           e.sigma, e.initial_cost, e.final_cost, e.iterations, e.solve_ms,
           e.inliers, e.num_rejected);
}

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

void BindMotionEstimate(py::module_* module) {
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
           "robust spread of the residuals over the assumed noise");
  property("initial_cost", &MotionEstimate::initial_cost,
           "robust cost at the initial guess");
  property("final_cost", &MotionEstimate::final_cost,
           "robust cost at the estimated motion");
  property("iterations", &MotionEstimate::iterations,
           "solver iterations of all stages");
  property("solve_ms", &MotionEstimate::solve_ms, "solver time, ms");
  result.def("__repr__", &ResultInWords).def(Pickled<EstimateResult>());
}

std::optional<MotionPrior> PriorFrom(const py::object& prior) {
  if (prior.is_none()) return std::nullopt;
  if (!py::isinstance<py::sequence>(prior) || py::len(prior) != 2) {
    throw InputError(
        "prior: must be a pair of a (4, 4) motion and its (6, 6) covariance");
  }
  const py::sequence pair = prior;
  MotionPrior result;
  result.mean = RigidFromArray(pair[0], "prior[0]");
  const MotionMatrix covariance = SymmetricFrom<6>(pair[1], "prior[1]");
  // That of a failed estimate: nothing is known.
  if (covariance.isZero(0.0)) return std::nullopt;
  const Eigen::LLT<MotionMatrix> cholesky(covariance);
  if (cholesky.info() != Eigen::Success) {
    throw InputError("prior[1]: is not positive definite");
  }
  result.information = cholesky.solve(MotionMatrix::Identity());
  return result;
}

// The rows that concern only matches.
std::vector<Setting> EstimateTable(OdometrySettings* settings) {
  std::vector<Setting> rows;
  for (const Setting& setting : SettingTable(settings)) {
    if (setting.group == kEstimationGroup) rows.push_back(setting);
  }
  return rows;
}

// Moves the values of matches to their input rows; zero elsewhere.
template <typename From, typename To = From>
std::vector<To> AtRows(const std::vector<From>& values,
                       const std::vector<size_t>& rows, size_t size) {
  std::vector<To> result(size);
  for (size_t i = 0; i < rows.size(); ++i) result[rows[i]] = values[i];
  return result;
}

// The result of an estimate from `matches`, for `size` input rows.
EstimateResult MakeResult(MotionEstimate estimate, const RowMatches& matches,
                          size_t size) {
  const std::vector<size_t>& rows = matches.rows;
  std::vector<uint8_t> inliers =
      AtRows<bool, uint8_t>(estimate.is_inlier, rows, size);
  estimate.weights = AtRows(estimate.weights, rows, size);
  estimate.residual_norms = AtRows(estimate.residual_norms, rows, size);
  estimate.residual_degrees = AtRows(estimate.residual_degrees, rows, size);
  return {std::move(estimate), std::move(inliers), matches.matches.rejected()};
}

// Defines a function that takes matches as two arrays of rows.
template <typename CameraArgument>
void BindFunction(py::module_* module, const char* name,
                  ToObservation to_observation, const char* prev_name,
                  const char* cur_name, const CameraArgument& camera_argument,
                  const char* doc) {
  const auto estimate = [=](const py::object& prev, const py::object& cur,
                            const RgbdCamera* camera,
                            const py::object& initial_guess, double sigma_px,
                            const py::object& normals_cur,
                            const py::object& prior_object, int threads,
                            const py::kwargs& keywords) {
    const MatchArrays arrays(prev, prev_name, cur, cur_name, normals_cur,
                             sigma_px);
    Rigid3d start;
    const InitialGuess* guess = nullptr;
    if (py::isinstance<py::str>(initial_guess)) {
      guess = &RowOf(InitialGuesses(), "initial guess",
                     initial_guess.cast<std::string>());
    } else {
      start = RigidFromArray(initial_guess, "initial_guess");
    }
    const std::optional<MotionPrior> prior = PriorFrom(prior_object);
    OdometrySettings settings;
    SetFromKeywords(name, keywords, EstimateTable(&settings));
    settings.estimator.options.threads = threads;
    if (threads > kMaxThreads) {
      throw InputError("threads must not exceed " +
                       std::to_string(kMaxThreads));
    }
    Estimator estimator = MakeEstimator(settings.estimator);
    const RgbdCamera seen_by = camera == nullptr ? RgbdCamera() : *camera;

    const ReleasedGil no_gil;
    const RowMatches matches = arrays.Make(seen_by.camera, to_observation,
                                           NoiseFor(settings, seen_by));
    if (guess != nullptr) start = guess->find(matches.matches).value_or(start);
    return MakeResult(estimator.Estimate(matches.matches, start,
                                         prior.has_value() ? &*prior : nullptr),
                      matches, arrays.size());
  };
  OdometrySettings settings;
  DefineWithSettings(module, name, estimate, EstimateTable(&settings), doc,
                     py::arg(prev_name), py::arg(cur_name), camera_argument,
                     py::kw_only(), py::arg("initial_guess") = "identity",
                     py::arg("sigma_px") = 0.5,
                     py::arg("normals_cur") = py::none(),
                     py::arg("prior") = py::none(), py::arg("threads") = 1);
}

}  // namespace

void BindEstimate(py::module_* module) {
  BindMotionEstimate(module);
  BindFunction(module, "estimate_motion", ObservePoint, "points_prev",
               "points_cur", py::arg("camera") = py::none(), R"(
Estimates the motion between two frames from matched 3D points.

points_prev, points_cur: (N, 3) x y z in camera axes (m; x right, y down, z
    forward); row i of both is match i. float64 and float32 of any strides are
    read without a copy. Rows that are not finite or have z <= 0 are ignored and
    get the weight 0.
camera: determines, with sigma_px, the lateral noise, and the noise of depth if
    it states one (depth_noise "camera"); None: fx = fy = 525.
initial_guess: where the solver starts: "identity", "ransac", "clique", or a
    (4, 4) cur_from_prev.
sigma_px: standard deviation of u and of v in each frame (px).
normals_cur: (N, 3) unit normals of the surface in the current camera's axes,
    zeros where unknown; for the cost point_to_plane.
prior: a pair of a (4, 4) cur_from_prev and its (6, 6) covariance, zero if nothing
    is known, as of a failed estimate; for the cost motion_prior.
threads: for tens of thousands of matches; the result does not depend on it.

Bad data is reported by the status of the estimate, never by an exception;
invalid arguments raise InputError. The GIL is released.)");
  BindFunction(module, "estimate_motion_pixels", ObservePixel, "pixels_prev",
               "pixels_cur", py::arg("camera").none(false), R"(
estimate_motion for matches in the images.

pixels_prev, pixels_cur: (N, 3) u v depth: pixel of the original (distorted)
    image and depth along the optical axis (m), 0 if none was measured: costs
    that need no depth still use such rows. Rows that are not finite or have a
    negative depth are ignored.
camera: the camera of both images.

All other arguments are those of estimate_motion.)");
}

}  // namespace rgbd_pose
