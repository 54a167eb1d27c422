// Compares the linearised direct costs with the image itself: each point is
// moved, projected and interpolated with ceres::Jet, following the formulas of
// the costs.

#include <ceres/jet.h>
#include <gtest/gtest.h>

#include <cmath>

#include "costs/cost_list.h"
#include "tests/support/both_jacobians.h"
#include "tests/support/direct_columns.h"
#include "tests/support/problem_sums.h"

namespace rgbd_pose {
namespace {

// Derivatives by the motion and by the depth of the point along its ray.
using Jet = ceres::Jet<double, 7>;

struct Sums {
  NormalEquations normal;
  int rows = 0;

  void Add(double w, const Jet& r) {
    const MotionVector J = w * r.v.head<6>();
    normal.cost += 0.5 * w * w * r.a * r.a;
    normal.gradient += w * r.a * J;
    normal.hessian += J * J.transpose();
    ++rows;
  }
};

// q = R (X - C) at the motion x = 0.
Eigen::Matrix<Jet, 3, 1> Move(const Rigid3d& cur_from_prev,
                              const Eigen::Vector3d& X) {
  Jet x[6];
  for (int i = 0; i < 6; ++i) x[i] = Jet(0.0, i);
  const RotationAndCenter<Jet> pose =
      LinearizationPoint(cur_from_prev).PoseAt(x);
  const Jet farther = Jet(1.0) + Jet(0.0, 6) / X.z();
  const Eigen::Matrix<Jet, 3, 1> from_centre = X.cast<Jet>() * farther - pose.C;
  return pose.R * from_centre;
}

// OpenCV's plumb-bob model, px.
Eigen::Matrix<Jet, 2, 1> Project(const Camera& camera,
                                 const Eigen::Matrix<Jet, 3, 1>& q) {
  const Jet x = q[0] / q[2], y = q[1] / q[2], r2 = x * x + y * y;
  const Jet radial =
      1.0 + camera.k1 * r2 + camera.k2 * r2 * r2 + camera.k3 * r2 * r2 * r2;
  const Jet xd =
      x * radial + 2.0 * camera.p1 * x * y + camera.p2 * (r2 + 2.0 * x * x);
  const Jet yd =
      y * radial + 2.0 * camera.p2 * x * y + camera.p1 * (r2 + 2.0 * y * y);
  return {camera.fx * xd + camera.cx, camera.fy * yd + camera.cy};
}

// The position of a point when the row that shows it is exposed.
Eigen::Vector3d InRow(const Camera& camera, const Shutter& shutter,
                      const Twist& twist, const Eigen::Vector3d& q) {
  Eigen::Vector3d moved = q;
  if (!shutter.IsGlobal()) {
    MoveToRow(camera, camera.MakeLens(), shutter, twist, q.data(),
              moved.data());
  }
  return moved;
}

// The pixel of a point in its row; derivatives by the motion at the stamp.
Eigen::Matrix<Jet, 2, 1> ProjectInRow(const Camera& camera,
                                      const FrameTiming& timing,
                                      const Eigen::Matrix<Jet, 3, 1>& q) {
  const Eigen::Vector3d at_stamp(q[0].a, q[1].a, q[2].a);
  const Eigen::Vector3d moved =
      InRow(camera, timing.color, timing.twist, at_stamp);
  const double shift_x = moved.x() / moved.z() - at_stamp.x() / at_stamp.z();
  const double shift_y = moved.y() / moved.z() - at_stamp.y() / at_stamp.z();
  return Project(camera,
                 {q[0] / q[2] + shift_x, q[1] / q[2] + shift_y, Jet(1.0)});
}

Eigen::VectorXd Column(const PackedColumns& points, int size, int i) {
  Eigen::VectorXd point(size);
  for (int k = 0; k < size; ++k) {
    point[k] = points.values[k * points.stride + i];
  }
  return point;
}

// Adds the residual of a point to the sums, following the cost's formula.
template <typename Residual>
void AddOf(Residual, const DirectInput&, const Rigid3d&, const Eigen::VectorXd&,
           Sums*) {
  static_assert(!sizeof(Residual),
                "a new cost needs an AddOf here: the same residual computed "
                "through the image");
}

void AddOf(Photometric, const DirectInput& input, const Rigid3d& motion,
           const Eigen::VectorXd& point, Sums* sums) {
  const FrameView::Level& level = input.cur->levels[input.level];
  const Eigen::Matrix<Jet, 3, 1> q = Move(motion, point.head<3>());
  if (!(q[2].a > DirectInput::kMinDepth)) return;
  const Eigen::Matrix<Jet, 2, 1> at =
      ProjectInRow(level.camera, input.cur->timing, q);
  if (!(at[0].a >= 1.0 && at[1].a >= 1.0 && at[0].a < level.gray.width - 2 &&
        at[1].a < level.gray.height - 2)) {
    return;
  }
  const int u = static_cast<int>(at[0].a), v = static_cast<int>(at[1].a);
  const Jet s = at[0] - static_cast<double>(u);
  const Jet t = at[1] - static_cast<double>(v);
  const auto gray = [&](int i, int j) {
    return Jet(level.gray.At(u + i, v + j));
  };
  const Jet r = (1.0 - s) * (1.0 - t) * gray(0, 0) +
                s * (1.0 - t) * gray(1, 0) + (1.0 - s) * t * gray(0, 1) +
                s * t * gray(1, 1) - input.gain * point[4] - input.bias;
  const double sigma_gray = Photometric::kSigmaGray;
  const double sigma = std::hypot(
      sigma_gray * std::sqrt(1.0 + input.gain * input.gain), r.v[6] * point[3]);
  sums->Add(1.0 / sigma, r);
}

// The plane N . p = 1 in current axes: slope of the previous plane, distance
// from nine inverse depths. Measure() is false if a depth is missing.
struct PlaneOracle {
  Eigen::Vector3d N;
  double chi2 = 0.0;  // of the nine; 1 is the 99 % quantile for 8 degrees

  bool Measure(const FrameView& cur, const Rigid3d& motion,
               const Eigen::VectorXd& point) {
    const Eigen::Vector3d q = motion * Eigen::Vector3d(point.head<3>());
    if (!(q.z() > DirectInput::kMinDepth)) return false;
    const Camera& camera = cur.levels[0].camera;
    const Eigen::Vector3d taken =
        InRow(camera, cur.timing.depth, cur.timing.twist, q);
    const Eigen::Vector2d at = camera.Project(taken);
    const double border = kSurfaceStep + 1.0;
    if (!(at.minCoeff() >= border && at.x() < camera.width - 1.0 - border &&
          at.y() < camera.height - 1.0 - border)) {
      return false;
    }
    const int u = static_cast<int>(std::lround(at.x()));
    const int v = static_cast<int>(std::lround(at.y()));
    N = motion.rotation * Eigen::Vector3d(point.segment<3>(3));
    N /= N.dot(q);
    const Eigen::Vector2d per_px(N.x() / camera.fx, N.y() / camera.fy);
    Eigen::Matrix<double, 9, 1> off;
    for (int k = 0; k < 9; ++k) {
      const Eigen::Vector2i step(kSurfaceStep * (k % 3 - 1),
                                 kSurfaceStep * (k / 3 - 1));
      const double z = cur.DepthAt(u + step.x(), v + step.y());
      if (z == 0.0) return false;
      off[k] = 1.0 / z - per_px.dot(step.cast<double>()) + 1.0 / q.z() -
               1.0 / taken.z();
    }
    const double sigma = point[6] / (point[2] * point[2]);
    chi2 = (off.array() - off.mean()).square().sum() / (sigma * sigma) / 20.1;
    const double inverse_z =
        off.mean() + per_px.dot(at - Eigen::Vector2d(u, v));
    N.z() = inverse_z - (N.x() * q.x() + N.y() * q.y()) / q.z();
    return true;
  }
};

void AddOf(ProjectivePlane, const DirectInput& input, const Rigid3d& motion,
           const Eigen::VectorXd& point, Sums* sums) {
  PlaneOracle plane;
  if (!plane.Measure(*input.cur, motion, point)) return;
  const Eigen::Matrix<Jet, 3, 1> q = Move(motion, point.head<3>());
  const Eigen::Vector3d n = plane.N.normalized();
  const double distance = 1.0 / plane.N.norm();
  const Jet r = n.x() * q[0] + n.y() * q[1] + n.z() * q[2] - distance;
  const double far = r.a / 0.2;
  if (plane.chi2 + far * far >= 1.0) return;
  // The part of a depth error that lies along n.
  const double sigma = kSurfaceSigma * point[6] * distance / q[2].a;
  sums->Add(1.0 / sigma, r);
}

void AddOf(InverseDepth, const DirectInput& input, const Rigid3d& motion,
           const Eigen::VectorXd& point, Sums* sums) {
  PlaneOracle plane;
  if (!plane.Measure(*input.cur, motion, point)) return;
  const Eigen::Matrix<Jet, 3, 1> q = Move(motion, point.head<3>());
  const Jet measured =
      plane.N.x() * q[0] / q[2] + plane.N.y() * q[1] / q[2] + plane.N.z();
  const Jet r = measured - 1.0 / q[2];
  const double far = r.a * q[2].a / 0.1;
  if (plane.chi2 + far * far >= 1.0) return;
  const double sigma = kSurfaceSigma * point[6] / (point[2] * point[2]);
  sums->Add(1.0 / sigma, r);
}

// Increases contrast and changes the exposure relative to the previous frame.
void Brighten(DirectFrame* frame) {
  frame->frame.gray.convertTo(frame->frame.gray, -1, 1.2, -10.0);
  frame->Build();
}

template <typename Residual>
class DirectOracleTest : public ::testing::Test {
 protected:
  // `away`: displacement of the current frame; small, but with a gradient.
  void Compare(bool is_distorted, int level,
               const Eigen::Vector3d& away = {0.003, -0.002, 0.004},
               const FrameTiming& timing = {}) {
    DirectPair pair(SyntheticDataset(SmallImages(is_distorted)), 10, 12);
    pair.cur.frame.color_shutter = timing.color;
    pair.cur.frame.depth_shutter = timing.depth;
    pair.cur.frame.twist = timing.twist;
    Brighten(&pair.cur);
    const Rigid3d motion = Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(
                                       0.002, Eigen::Vector3d::UnitY())),
                                   away) *
                           pair.cur_from_prev;
    DirectOptions options;
    options.max_points = kMaxPoints;
    options.finest_level = level;
    DirectCostOf<Residual> cost(options);
    cost.Bind(pair.data());
    cost.Associate(motion);
    NormalEquations actual;
    const MotionVector zero = MotionVector::Zero();
    cost.Linearise(LinearizationPoint(motion).DerivativesAt(zero.data()),
                   nullptr, &actual);
    const PackedColumns points = PointsOf<Residual>(pair, level, kMaxPoints);
    DirectInput input = InputOf(pair, level, motion);
    if (Residual::kSeesBrightness) EstimateBrightness(points, &input);
    Sums expected;
    for (int i = 0; i < points.size; ++i) {
      AddOf(Residual(), input, motion,
            Column(points, Residual::kPointColumns, i), &expected);
    }
    EXPECT_GT(expected.rows, 200);
    EXPECT_LT(expected.rows, points.size) << "all are seen: no test of that";
    EXPECT_EQ(cost.matches().size(), expected.rows);
    // Positions within a pixel are floats.
    constexpr double kRounding = 1e-6;
    EXPECT_LE(SumsError(actual, expected.normal), kRounding);
  }

  static constexpr int kMaxPoints = 1000;
};
TYPED_TEST_SUITE(DirectOracleTest, AsGTestTypes<DirectResidualTypes>::type,
                 CostName);

TYPED_TEST(DirectOracleTest, SumsAreThoseThroughTheImage) {
  this->Compare(/*is_distorted=*/false, 0);
  this->Compare(/*is_distorted=*/false, 1);
}

TYPED_TEST(DirectOracleTest, WithLensDistortion) {
  this->Compare(/*is_distorted=*/true, 0);
  this->Compare(/*is_distorted=*/true, 1);
}

// The images are rendered at one moment. This tests only where they are read,
// not whether they match.
TYPED_TEST(DirectOracleTest, OfRowsExposedOneAfterAnother) {
  const Twist twist = {{0.5, -0.8, 0.4}, {0.4, 0.3, -0.5}};
  for (const FrameTiming& timing :
       {FrameTiming{{-0.0075, 0.028}, {-0.018, 0.028}, twist},
        FrameTiming{{0.01, -0.02}, {0.0, 0.0}, twist},
        FrameTiming{{0.0, 0.0}, {0.015, 0.0}, twist}}) {
    for (const bool is_distorted : {false, true}) {
      for (const int level : {0, 1}) {
        this->Compare(is_distorted, level, {0.003, -0.002, 0.004}, timing);
      }
    }
  }
}

// At the limit for another surface: some points are beyond it.
TYPED_TEST(DirectOracleTest, FarFromTheSurface) {
  for (const double z : {-0.22, -0.16, 0.16, 0.22}) {
    this->Compare(/*is_distorted=*/false, 0, {0.02, -0.03, z});
  }
}

}  // namespace
}  // namespace rgbd_pose
