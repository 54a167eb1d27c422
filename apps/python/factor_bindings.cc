#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/python/any_factor.h"
#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/factor_arguments.h"
#include "core/factors/common_direction.h"
#include "core/factors/distance.h"
#include "core/factors/relative_pose.h"
#include "core/geometry/camera.h"
#include "core/inertial/preintegration.h"
#include "core/util/input_error.h"
#include "costs/factors/absolute_pose.h"
#include "costs/factors/absolute_position.h"
#include "costs/factors/constant_velocity.h"
#include "costs/factors/gravity.h"
#include "costs/factors/gyroscope.h"
#include "costs/factors/inertial.h"
#include "costs/factors/landmark.h"
#include "costs/factors/map_plane.h"
#include "costs/factors/relative_rotation.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// Independent residuals of a factor.
template <typename Factor>
constexpr int kDegrees = Factor::kRows;
// Both have three rows of rank 2.
template <>
constexpr int kDegrees<GravityFactor> = 2;
template <>
constexpr int kDegrees<CommonDirectionFactor> = 2;

// A type of its own for each factor, for its Python class.
template <typename Factor>
struct FactorOf : AnyFactor {
  // NOLINTNEXTLINE(google-explicit-constructor): for py::init.
  FactorOf(Factor factor)
      : AnyFactor{factors::KindsOf(typename Factor::Blocks()), kDegrees<Factor>,
                  std::make_shared<const SharedCostFunction>(
                      std::unique_ptr<ceres::CostFunction>(
                          MakeFactor(std::move(factor))))} {}
};

// Returns a function that defines the Python class of a factor:
//   factor(name, make, doc, arguments...)
// `make` takes the arguments of its constructor and returns a factor.
auto FactorsOf(py::module_* module) {
  return [module](const char* name, auto make, const char* doc,
                  const auto&... arguments) {
    using Signature = py::detail::function_signature_t<decltype(make)>;
    using Factor = typename std::function<Signature>::result_type;
    py::class_<FactorOf<Factor>, AnyFactor, std::shared_ptr<FactorOf<Factor>>>(
        *module, name, doc)
        .def(py::init(make), arguments...);
  };
}

void BindShelf(py::module_* module) {
  using py::object;
  const auto factor = FactorsOf(module);
  const py::tuple zero = py::make_tuple(0.0, 0.0, 0.0);
  factor(
      "AbsolutePoseFactor",
      [](const object& world_from_body, const object& covariance) {
        return AbsolutePoseFactor{
            RigidFromArray(world_from_body, "world_from_body"),
            SqrtInformationFrom<6>(covariance)};
      },
      R"(
A measured pose; over one pose.

world_from_body: (4, 4), m.
covariance: (6, 6) of [omega p], omega (rad) about the axes of the body, p (m)
    along those of the world, as Problem.covariance has it.)",
      py::arg("world_from_body"), py::arg("covariance"));
  factor(
      "AbsolutePositionFactor",
      [](const object& in_world, const object& covariance,
         const object& in_body) {
        return AbsolutePositionFactor{VectorFrom<3>(in_world, "in_world"),
                                      SqrtInformationFrom<3>(covariance),
                                      VectorFrom<3>(in_body, "in_body")};
      },
      R"(
A measured position of a point of the body, such as an antenna; over one pose.

in_world: (3,) the measured position, m.
covariance: (3, 3) of in_world, m^2.
in_body: (3,) the point in the axes of the body, m.)",
      py::arg("in_world"), py::arg("covariance"), py::arg("in_body") = zero);
  factor(
      "RelativePoseFactor",
      [](const object& cur_from_ref, const object& covariance) {
        return RelativePoseFactor{RigidFromArray(cur_from_ref, "cur_from_ref"),
                                  SqrtInformationFrom<6>(covariance)};
      },
      R"(
A measured motion between two poses; over the poses of `ref` and `cur`.

cur_from_ref: (4, 4), m, such as MotionEstimate.cur_from_prev.
covariance: (6, 6) of [omega C] as in MotionEstimate.covariance, rad and m.)",
      py::arg("cur_from_ref"), py::arg("covariance"));
  factor(
      "RelativeRotationFactor",
      [](const object& cur_from_ref, const object& covariance) {
        return RelativeRotationFactor{
            RotationFromArray(cur_from_ref, "cur_from_ref"),
            SqrtInformationFrom<3>(covariance)};
      },
      R"(
A measured rotation between two poses; over the poses of `ref` and `cur`.

cur_from_ref: (3, 3), turns the axes of `ref` into those of `cur`.
covariance: (3, 3) of omega (rad) about the axes of `cur`.)",
      py::arg("cur_from_ref"), py::arg("covariance"));
  factor(
      "GravityFactor",
      [](const object& in_body, const object& in_world, double sigma) {
        return GravityFactor{DirectionFrom(in_body, "in_body"),
                             DirectionFrom(in_world, "in_world"),
                             Positive(sigma, "sigma")};
      },
      R"(
A direction that is known in the world, such as gravity; over one pose.

in_body, in_world: (3,) the direction as measured in the axes of the body, and
    as known in the world; of any length.
sigma: standard deviation of the measured direction, rad.)",
      py::arg("in_body"), py::arg("in_world"), py::arg("sigma") = 0.01);
  factor(
      "CommonDirectionFactor",
      [](const object& in_a, const object& in_b, double sigma) {
        return CommonDirectionFactor{DirectionFrom(in_a, "in_a"),
                                     DirectionFrom(in_b, "in_b"),
                                     Positive(sigma, "sigma")};
      },
      R"(
A direction that two bodies measure, wherever it points in the world; over the
poses a and b.

in_a, in_b: (3,) the direction in the axes of each body; of any length.
sigma: standard deviation of the angle between the two, rad.)",
      py::arg("in_a"), py::arg("in_b"), py::arg("sigma") = 0.01);
  factor(
      "ConstantVelocityFactor",
      [](double seconds, double angular_density, double linear_density) {
        return ConstantVelocityFactor{
            Positive(seconds, "seconds"),
            Positive(angular_density, "angular_density"),
            Positive(linear_density, "linear_density")};
      },
      R"(
A body that keeps its angular velocity about its own axes, and its linear velocity
in the world, but for white noise of its accelerations; over pose a, twist a,
pose b, twist b.

seconds: from a to b, s.
angular_density: of the noise, rad/s^2/sqrt(Hz): about how much the angular
    velocity changes in a second.
linear_density: the same of the linear velocity, m/s^2/sqrt(Hz).)",
      py::arg("seconds"), py::arg("angular_density") = 1.0,
      py::arg("linear_density") = 1.0);
  factor(
      "DistanceFactor",
      [](double metres, double sigma, const object& in_a, const object& in_b) {
        if (metres < 0.0) throw InputError("metres: must not be negative");
        return DistanceFactor{
            Finite(metres, "metres"), Positive(sigma, "sigma"),
            VectorFrom<3>(in_a, "in_a"), VectorFrom<3>(in_b, "in_b")};
      },
      R"(
A known distance between a point of one body and a point of another; over the
poses a and b. Where the points coincide it has no direction and moves nothing.

metres: the measured distance.
sigma: its standard deviation, m.
in_a, in_b: (3,) the points in the axes of their bodies, m.)",
      py::arg("metres"), py::arg("sigma") = 0.01, py::arg("in_a") = zero,
      py::arg("in_b") = zero);
  factor(
      "MapPlaneFactor",
      [](const object& in_body, const object& normal, double distance,
         double sigma) {
        const Eigen::Vector3d n = VectorFrom<3>(normal, "normal");
        if (!(std::abs(n.norm() - 1.0) <= 0.01)) {
          throw InputError("normal: must be of length 1");
        }
        return MapPlaneFactor{VectorFrom<3>(in_body, "in_body"), n.normalized(),
                              Finite(distance, "distance"),
                              Positive(sigma, "sigma")};
      },
      R"(
A point that the body measures on a plane of the world; over one pose.

in_body: (3,) the point in the axes of the body, m.
normal: (3,) of the plane in the axes of the world, of length 1.
distance: of the plane from the origin along its normal, m.
sigma: standard deviation of the point along the normal, m.)",
      py::arg("in_body"), py::arg("normal"), py::arg("distance"),
      py::arg("sigma") = 0.01);
  factor(
      "LandmarkFactor",
      [](const RgbdCamera& camera, const object& ray, const object& pixel,
         double sigma_px) {
        const Eigen::Vector2d at = VectorFrom<2>(ray, "ray");
        return LandmarkFactor{camera.camera, at.homogeneous(),
                              VectorFrom<2>(pixel, "pixel"),
                              Positive(sigma_px, "sigma_px")};
      },
      R"(
The pixel at which a view sees a point on a ray of another frame, its anchor;
over the poses of anchor and view, and the inverse depth (1/m) in the anchor.

camera: that of the view.
ray: (2,) x and y of the ray (x, y, 1) in the axes of the anchor.
pixel: (2,) u v in the view, with the distortion of the lens, px.
sigma_px: standard deviation of u and of v, px.)",
      py::arg("camera").none(false), py::arg("ray"), py::arg("pixel"),
      py::arg("sigma_px") = 1.0);
  factor(
      "InertialFactor",
      [](const PreintegratedMotion& motion, const object& gravity) {
        return InertialFactor(motion, VectorFrom<3>(gravity, "gravity"));
      },
      R"(
What an inertial sensor measured from i to j; over pose i, velocity i, bias i,
pose j, velocity j, bias j. Poses are those of the sensor, world_from_sensor;
a velocity is (3,) in the axes of the world, m/s; a bias is (6,), what the sensor
adds to the angular velocity (rad/s) and to the acceleration (m/s^2).

motion: preintegrated samples. For a bias that moves far from motion.bias
    (0.01 rad/s over a second), preintegrate again and make a new factor.
gravity: (3,) in the axes of the world, towards the ground, m/s^2.)",
      py::arg("motion").none(false), py::arg("gravity"));
  factor(
      "GyroscopeFactor",
      [](const PreintegratedMotion& motion) { return GyroscopeFactor(motion); },
      R"(
What a gyroscope alone measured from i to j; over pose i, pose j, bias. Poses are
those of the sensor, world_from_sensor; the bias is (3,), what the gyroscope adds
to the angular velocity, rad/s. That of several factors may be the same block.

motion: preintegrated samples; their accelerations are of no importance.)",
      py::arg("motion").none(false));
}

std::string FactorInWords(const py::object& self) {
  return std::string(py::str(py::type::of(self).attr("__name__"))) + "(" +
         BlockNames(self.cast<const AnyFactor&>()) + ")";
}

// The residuals, and the Jacobians in the tangents of the blocks.
py::tuple Evaluate(const AnyFactor& self, const py::sequence& blocks) {
  CheckBlockCount(self, "evaluate", blocks.size());
  const size_t count = self.blocks.size();
  const int rows = self.function->num_residuals();
  std::vector<Eigen::VectorXd> x(count);
  std::vector<RowMajorMatrix> jacobians(count);
  std::vector<const double*> x_pointers;
  std::vector<double*> jacobian_pointers;
  for (size_t i = 0; i < count; ++i) {
    const int size = self.blocks[i].size;
    const NumberArray numbers(
        blocks[i], "evaluate: blocks[" + std::to_string(i) + "]", {size});
    x[i] =
        Eigen::VectorXd::NullaryExpr(size, [&](int k) { return numbers(k); });
    jacobians[i].resize(rows, size);
    x_pointers.push_back(x[i].data());
    jacobian_pointers.push_back(jacobians[i].data());
  }
  RowMajorMatrix residuals(rows, 1);
  if (!self.function->Evaluate(x_pointers.data(), residuals.data(),
                               jacobian_pointers.data())) {
    throw InputError("evaluate: the factor has no residual at these blocks");
  }
  py::list in_tangents;
  for (size_t i = 0; i < count; ++i) {
    in_tangents.append(ArrayFromMatrix(
        jacobians[i] * self.blocks[i].plus_jacobian(x[i].data())));
  }
  return py::make_tuple(ArrayFromMatrix(residuals).attr("ravel")(),
                        in_tangents);
}

}  // namespace

void BindFactors(py::module_* module) {
  py::class_<AnyFactor, std::shared_ptr<AnyFactor>>(*module, "Factor", R"(
A residual over parameter blocks, for Problem.add_residual_block. Residuals are
whitened: one sigma is 1. Each kind of factor is a class of its own.

Blocks are float64 arrays: a pose, world_from_body, is (7,) qx qy qz qw x y z (m;
see pose_block), a twist, the velocity of a body in its own axes, is (6,) angular
(rad/s) and linear (m/s), an inverse depth is (1,) 1/m.)")
      .def("evaluate", &Evaluate, py::arg("blocks"), R"(
Returns the residuals (rows,), in sigmas, and a list of their Jacobians
(rows, 6) in the tangent of each block; (rows, N) for blocks of N numbers other
than poses.

Raises InputError for wrong blocks, and where there is no residual.)")
      .def("__repr__", &FactorInWords);
  BindShelf(module);
  BindPairFactor(module);
}

}  // namespace rgbd_pose
