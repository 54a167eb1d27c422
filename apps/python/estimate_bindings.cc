#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/estimator_settings.h"
#include "apps/named_values.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "core/camera.h"
#include "core/correspondences.h"
#include "core/estimator.h"
#include "core/initial_guess.h"
#include "core/input_error.h"
#include "costs/cost_factory.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// More than any machine can use for this.
constexpr int kMaxThreads = 256;

// An estimate whose lists hold one entry for each row that was given, accepted
// as a match or not.
struct EstimateResult {
  MotionEstimate estimate;
  std::vector<uint8_t> is_inlier;
  size_t num_rejected = 0;
};

// Matches and the rows of the given arrays that they are.
struct RowMatches {
  Correspondences matches;
  std::vector<size_t> rows;
};

// What a camera has seen, from a row of three numbers.
using ToObservation = Observation (*)(const Camera& camera,
                                      const Eigen::Vector3d& row);

// From x, y, z in camera axes (m). z = 0 gives no numbers: no match.
Observation ObservePoint(const Camera& camera, const Eigen::Vector3d& point) {
  Observation o;
  o.u = camera.fx * point.x() / point.z() + camera.cx;
  o.v = camera.fy * point.y() / point.z() + camera.cy;
  o.depth = point.z();
  return o;
}

// From an image pixel u, v (px) and a depth (m), 0 where none was measured.
Observation ObservePixel(const Camera& camera, const Eigen::Vector3d& pixel) {
  const Eigen::Vector2d ideal = camera.Undistort(pixel.head<2>());
  Observation o;
  o.u = ideal.x();
  o.v = ideal.y();
  o.depth = pixel.z();
  return o;
}

Eigen::Vector3d Row(const NumberArray& array, size_t i) {
  return {array(i, 0), array(i, 1), array(i, 2)};
}

// Needs no GIL.
RowMatches MakeMatches(const Camera& camera, ToObservation to_observation,
                       const NumberArray& prev, const NumberArray& cur,
                       const NumberArray* normals_cur, double sigma_px,
                       const DepthNoiseModel& depth_noise) {
  RowMatches result;
  result.matches = Correspondences(camera);
  result.matches.Reserve(prev.size());
  result.rows.reserve(prev.size());
  const auto observe = [&](const NumberArray& array, size_t i) {
    Observation o = to_observation(camera, Row(array, i));
    o.sigma_px = sigma_px;
    if (o.depth > 0.0) o.sigma_depth = depth_noise.sigma(o.depth);
    return o;
  };
  for (size_t i = 0; i < prev.size(); ++i) {
    Observation seen = observe(cur, i);
    if (normals_cur != nullptr) seen.normal = Row(*normals_cur, i);
    if (result.matches.Add(observe(prev, i), seen)) result.rows.push_back(i);
  }
  return result;
}

// The values of matches at the rows they were given in; zeros elsewhere.
template <typename To, typename From>
std::vector<To> AtRows(const std::vector<From>& values,
                       const std::vector<size_t>& rows, size_t size) {
  std::vector<To> result(size);
  for (size_t i = 0; i < rows.size(); ++i) result[rows[i]] = values[i];
  return result;
}

// Needs no GIL.
EstimateResult Finish(MotionEstimate estimate, const RowMatches& matches,
                      size_t size) {
  EstimateResult result;
  const std::vector<size_t>& rows = matches.rows;
  result.num_rejected = matches.matches.rejected();
  result.is_inlier = AtRows<uint8_t>(estimate.is_inlier, rows, size);
  if (result.num_rejected > 0) {
    estimate.weights = AtRows<double>(estimate.weights, rows, size);
    estimate.residual_norms =
        AtRows<double>(estimate.residual_norms, rows, size);
    estimate.residual_degrees =
        AtRows<int>(estimate.residual_degrees, rows, size);
  }
  result.estimate = std::move(estimate);
  return result;
}

// Where the solver starts: a motion, or a way to find one in the matches.
struct Start {
  Rigid3d cur_from_prev;
  const InitialGuess* guess = nullptr;

  explicit Start(const py::object& initial_guess) {
    if (!py::isinstance<py::str>(initial_guess)) {
      cur_from_prev = RigidFromArray(initial_guess, "initial_guess");
      return;
    }
    const auto name = initial_guess.cast<std::string>();
    guess = FindInitialGuess(name);
    if (guess != nullptr) return;
    std::vector<std::string> names;
    for (const InitialGuess& row : InitialGuesses()) {
      names.emplace_back(row.name);
    }
    throw UnknownName("initial guess", name, names);
  }

  Rigid3d Find(const Correspondences& matches) const {
    if (guess == nullptr) return cur_from_prev;
    return guess->find(matches).value_or(Rigid3d());
  }
};

std::optional<MotionPrior> PriorFrom(const py::object& prior) {
  if (prior.is_none()) return std::nullopt;
  if (!py::isinstance<py::sequence>(prior) || py::len(prior) != 2) {
    throw InputError(
        "prior: must be a pair of a (4, 4) motion and its (6, 6) covariance");
  }
  const py::sequence pair = prior;
  MotionPrior result;
  result.cur_from_prev = RigidFromArray(pair[0], "prior[0]");
  const NumberArray covariance(pair[1], "prior[1]", {6, 6});
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) result.covariance(i, j) = covariance(i, j);
  }
  return result;
}

EstimatorOptions OptionsFrom(const EstimatorSettings& settings,
                             int max_iterations, int threads) {
  EstimatorOptions options = MakeEstimatorOptions(settings);
  options.max_iterations = max_iterations;
  options.threads = threads;
  const std::string problem = options.Check();
  if (!problem.empty()) throw InputError(problem);
  if (threads > kMaxThreads) {
    throw InputError("threads must not exceed " + std::to_string(kMaxThreads));
  }
  return options;
}

void CheckSizes(const NumberArray& prev, const std::string& prev_name,
                const NumberArray& other, const std::string& other_name) {
  if (prev.size() == other.size()) return;
  throw InputError(prev_name + " has " + std::to_string(prev.size()) +
                   " rows and " + other_name + " " +
                   std::to_string(other.size()) +
                   "; row i of both must belong to match i");
}

// Defines a function that takes matches as two arrays of rows.
template <typename CameraArgument>
void BindFunction(py::module_* module, const char* name,
                  ToObservation to_observation, const char* prev_name,
                  const char* cur_name, const CameraArgument& camera_argument,
                  const char* doc) {
  const auto estimate =
      [=](const py::object& prev_object, const py::object& cur_object,
          const RgbdCamera* camera, const std::string& cost,
          const std::string& loss, const std::string& scale,
          const std::string& robust_schedule, const py::object& initial_guess,
          double sigma_px, const std::string& depth_noise,
          const py::object& normals_object, const py::object& prior_object,
          const std::string& assembly, int max_iterations, int threads) {
        const NumberArray prev(prev_object, prev_name, {NumberArray::kAny, 3});
        const NumberArray cur(cur_object, cur_name, {NumberArray::kAny, 3});
        CheckSizes(prev, prev_name, cur, cur_name);
        std::optional<NumberArray> normals;
        if (!normals_object.is_none()) {
          normals.emplace(normals_object, "normals_cur",
                          std::vector<py::ssize_t>{NumberArray::kAny, 3});
          CheckSizes(prev, prev_name, *normals, "normals_cur");
        }
        if (!std::isfinite(sigma_px) || sigma_px <= 0.0) {
          throw InputError("sigma_px must be a positive number of pixels");
        }
        const Start start(initial_guess);
        const std::optional<MotionPrior> prior = PriorFrom(prior_object);
        const DepthNoiseModel& noise = *DepthNoiseByName(depth_noise);
        Estimator estimator(
            OptionsFrom({cost, loss, assembly, scale, robust_schedule},
                        max_iterations, threads),
            MakeRobustCosts(cost, loss));
        const Camera seen_by = camera == nullptr ? Camera() : camera->camera;

        const py::gil_scoped_release no_gil;
        const RowMatches matches = MakeMatches(
            seen_by, to_observation, prev, cur,
            normals.has_value() ? &*normals : nullptr, sigma_px, noise);
        return Finish(
            estimator.Estimate(matches.matches, start.Find(matches.matches),
                               prior.has_value() ? &*prior : nullptr),
            matches, prev.size());
      };
  module->def(
      name, estimate, doc, py::arg(prev_name), py::arg(cur_name),
      camera_argument, py::kw_only(), py::arg("cost") = "bidirectional_point",
      py::arg("loss") = "tukey", py::arg("scale") = "fixed",
      py::arg("robust_schedule") = "gnc", py::arg("initial_guess") = "identity",
      py::arg("sigma_px") = 0.5, py::arg("depth_noise") = "khoshelham",
      py::arg("normals_cur") = py::none(), py::arg("prior") = py::none(),
      py::arg("assembly") = "compressed", py::arg("max_iterations") = 50,
      py::arg("threads") = 1);
}

std::string InWords(const EstimateResult& result) {
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
  // The object that Python has already, no copy.
  error.attr("estimate") = py::cast(&self, py::return_value_policy::reference);
  PyErr_SetObject(type.ptr(), error.ptr());
  throw py::error_already_set();
}

// A property that is a field of MotionEstimate.
template <auto kMember>
auto Field(const EstimateResult& result) {
  return result.estimate.*kMember;
}

// The same, a list seen as an array without a copy.
template <auto kMember>
py::array List(const py::object& self) {
  return ViewOf(self.cast<const EstimateResult&>().estimate.*kMember, self);
}

void BindResult(py::module_* module) {
  py::class_<EstimateResult> result(*module, "MotionEstimate", R"(
The motion between two frames as estimated, and what speaks for it. Arrays are
not to be written; those of N entries have one for each row that was given, 0
or False for rows that no cost could use.)");
  result.attr("_error_type") = module->attr("EstimateError");
  result
      .def_property_readonly(
          "status",
          [](const EstimateResult& self) {
            return ToString(self.estimate.status);
          },
          "'ok', 'too_few_matches' (fewer than three usable), 'degenerate' "
          "(some\ndirection of motion is not determined), 'not_converged' or\n"
          "'inconsistent' (too few matches agree with one motion)")
      .def_property_readonly("reason", &Field<&MotionEstimate::reason>,
                             "of the status, in words; empty if ok")
      .def_property_readonly(
          "ok", [](const EstimateResult& self) { return self.estimate.ok(); },
          "whether the status is 'ok'")
      .def("raise_if_failed", &RaiseIfFailed,
           py::return_value_policy::reference,
           "Raises EstimateError with status and reason unless ok; returns\n"
           "the estimate itself.")
      .def_property_readonly(
          "cur_from_prev",
          [](const EstimateResult& self) {
            return ArrayFromMatrix(
                MatrixFromRigid(self.estimate.cur_from_prev));
          },
          "(4, 4): point_in_cur = cur_from_prev @ point_in_prev (m); the "
          "guess,\nif the status is 'too_few_matches'")
      .def_property_readonly(
          "covariance",
          [](const EstimateResult& self) {
            return ArrayFromMatrix(self.estimate.covariance);
          },
          "(6, 6), of [omega_x omega_y omega_z Cx Cy Cz]: omega (rad) is a "
          "small\nrotation about the axes of the current camera, R_true = "
          "Exp(omega) R; C (m)\nis the centre of the current camera in the "
          "axes of the previous one. Zero\nunless the status is 'ok' or "
          "'inconsistent'.")
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
          "(N,) int32: independent measurements in it; the norm of right\n"
          "matches follows a chi distribution of so many degrees")
      .def_property_readonly("num_used", &Field<&MotionEstimate::num_used>,
                             "matches that some cost could use")
      .def_property_readonly("num_inliers",
                             &Field<&MotionEstimate::num_inliers>,
                             "of these, in agreement")
      .def_readonly("num_rejected", &EstimateResult::num_rejected,
                    "rows that are no match: not finite, or a negative depth")
      .def_property_readonly("sigma", &Field<&MotionEstimate::sigma>,
                             "robust spread of the whitened residuals, "
                             "ideally 1")
      .def_property_readonly("initial_cost",
                             &Field<&MotionEstimate::initial_cost>,
                             "robust cost at the guess")
      .def_property_readonly("final_cost", &Field<&MotionEstimate::final_cost>,
                             "robust cost at the motion")
      .def_property_readonly("iterations", &Field<&MotionEstimate::iterations>,
                             "of the solver, all stages together")
      .def_property_readonly("solve_ms", &Field<&MotionEstimate::solve_ms>,
                             "time that the solve took, ms")
      .def("__repr__", &InWords);
}

}  // namespace

void BindEstimate(py::module_* module) {
  module->attr("EstimateError") =
      py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(
          "rgbd_pose.EstimateError",
          "A motion that could not be estimated: its status and reason. "
          "`estimate` is the\nMotionEstimate.",
          PyExc_RuntimeError, nullptr));
  BindResult(module);
  BindFunction(module, "estimate_motion", ObservePoint, "points_prev",
               "points_cur", py::arg("camera") = py::none(), R"(
Estimates the motion between two frames from matched 3D points.

points_prev, points_cur: (N, 3) x y z in camera axes (m; x right, y down, z
    forward), row i of both being match i. float64 and float32 of any strides
    are read without a copy. Rows that are not finite, or whose z is 0 or less,
    are no match and get the weight 0.
camera: says, with sigma_px, how noisy points are sideways; None: fx = fy = 525.
cost: what a match is compared by (costs()); several add up: "a+b".
loss: M-estimator (losses()); one for all costs or one for each: "a,b".
scale: spread of the residuals: "fixed" (as the noise model says) or estimated
    by "mad", "sn" or "qn".
robust_schedule: "gnc" (losses start wide and narrow) or "direct".
initial_guess: where the solver starts: "identity", "ransac", "clique", or a
    (4, 4) cur_from_prev.
sigma_px: standard deviation of u and of v in each frame (px).
depth_noise: model of the standard deviation of depths: "khoshelham", "nguyen"
    or "constant".
normals_cur: (N, 3) unit normals of the surface in the current camera's axes,
    zeros where not known; for the cost point_to_plane.
prior: a pair of a (4, 4) cur_from_prev and its (6, 6) covariance; for the cost
    motion_prior.
assembly: "compressed", "per_match" or "autodiff": the same problem.
max_iterations: of the solver's last stage.
threads: for sums over tens of thousands of matches; the result is the same.

Bad data is a status of the estimate that is returned, never an exception;
arguments that make no sense raise InputError. The GIL is released.)");
  BindFunction(module, "estimate_motion_pixels", ObservePixel, "pixels_prev",
               "pixels_cur", py::arg("camera").none(false), R"(
estimate_motion for matches in the images.

pixels_prev, pixels_cur: (N, 3) u v depth: pixel of the image as it is
    (distorted as the camera says, px) and depth along the optical axis (m), 0
    where none was measured: costs that need no depth use such rows still. Rows
    that are not finite, or of a negative depth, are no match.
camera: that took both images.

All others are those of estimate_motion.)");
}

}  // namespace rgbd_pose
