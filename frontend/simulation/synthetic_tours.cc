#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "core/util/units.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_scene.h"

namespace rgbd_pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

// A way on the floor along a polygon with rounded corners, closed or back and
// forth: a uniform cubic B-spline with control points every kStep along the
// polygon. Its second derivative is continuous. On straight lines its
// parameter, in m, is the length.
class Way {
 public:
  Way(const std::vector<Vector2d>& corners, bool is_closed) {
    const size_t lines = corners.size() - (is_closed ? 0 : 1);
    double at = 0.0;  // position of the next point on this line
    for (size_t i = 0; i < lines; ++i) {
      const Vector2d& from = corners[i];
      const Vector2d line = corners[(i + 1) % corners.size()] - from;
      for (; at < line.norm(); at += kStep) {
        points_.push_back(from + line.normalized() * at);
      }
      at -= line.norm();
    }
    if (!is_closed) {
      for (int i = static_cast<int>(points_.size()) - 2; i > 0; --i) {
        points_.push_back(points_[i]);
      }
    }
  }

  // Length of one round, or of the way there and back, m.
  double length() const { return kStep * static_cast<double>(points_.size()); }

  Vector2d At(double s) const {
    const double place = s / kStep;
    const double whole = std::floor(place);
    const double u = place - whole;
    const double v = 1.0 - u;
    const double weights[] = {v * v * v, 4.0 - 6.0 * u * u + 3.0 * u * u * u,
                              4.0 - 6.0 * v * v + 3.0 * v * v * v, u * u * u};
    const long size = static_cast<long>(points_.size());
    Vector2d sum = Vector2d::Zero();
    for (long i = 0; i < 4; ++i) {
      const long index = (static_cast<long>(whole) + i - 1) % size;
      sum += weights[i] / 6.0 * points_[index < 0 ? index + size : index];
    }
    return sum;
  }

 private:
  static constexpr double kStep = 0.8;  // m

  std::vector<Vector2d> points_;
};

Vector3d Lift(const Vector2d& place, double height) {
  return {place.x(), place.y(), height};
}

// Motion of the hand: about 1 cm and 1 degree on each axis.
Rigid3d Sway(double t) {
  const auto wave = [t](double amplitude, double hz, double phase) {
    return amplitude * std::sin(2.0 * M_PI * hz * t + phase);
  };
  const Vector3d shift(wave(0.010, 0.53, 0.0), wave(0.015, 0.83, 1.0),
                       wave(0.010, 0.41, 2.0));
  const double pitch = wave(0.8 * kRadiansPerDegree, 0.67, 3.0);
  const double yaw = wave(1.2 * kRadiansPerDegree, 0.47, 4.0);
  const double roll = wave(1.0 * kRadiansPerDegree, 0.59, 5.0);
  return Rigid3d(AngleAxisd(pitch, Vector3d::UnitX()) *
                     AngleAxisd(yaw, Vector3d::UnitY()) *
                     AngleAxisd(roll, Vector3d::UnitZ()),
                 shift);
}

// Looks in the direction of the way's point `ahead` m further on, turned by
// `yaw` (rad, to the left), with a descent of `drop` per metre.
Rigid3d LookAhead(const Way& way, double s, double ahead, double yaw,
                  double height, double drop) {
  const Vector2d place = way.At(s);
  const Vector2d look = (way.At(s + ahead) - place).normalized();
  const Vector2d turned = Eigen::Rotation2Dd(yaw) * look;
  return LookAt(Lift(place, height), Lift(place + turned, height - drop));
}

}  // namespace

Rigid3d TableTour(double t, double /*duration*/) {
  static const Way way({{-3.1, -2.0}, {3.1, -2.0}, {3.1, 2.0}, {-3.1, 2.0}},
                       true);
  constexpr double kRound = 56.0;  // s
  const Vector2d place = way.At(way.length() * t / kRound);
  // Looks at the desks, from one end to the other, and to both sides of them.
  const double look = 12.0 * kRadiansPerDegree * std::sin(2.0 * M_PI * t / 7.0);
  return LookAt(Lift(place, 1.45), Lift(0.25 * place, 0.85)) *
         Rigid3d(Quaterniond(AngleAxisd(look, Vector3d::UnitY())),
                 Vector3d::Zero()) *
         Sway(t);
}

Rigid3d TwoRoomsTour(double t, double /*duration*/) {
  static const Way way({{-3.9, -1.4},
                        {-1.8, -1.4},
                        {-0.9, -0.3},
                        {0.9, 0.3},
                        {1.8, 1.4},
                        {4.1, 1.4},
                        {4.1, -1.4},
                        {1.8, -1.4},
                        {0.9, -0.3},
                        {-0.9, 0.3},
                        {-1.8, 1.4},
                        {-3.9, 1.4}},
                       true);
  constexpr double kRound = 57.0;  // s
  const double look = 12.0 * kRadiansPerDegree * std::sin(2.0 * M_PI * t / 9.5);
  return LookAhead(way, way.length() * t / kRound, 2.4, look, 1.45, 0.25) *
         Sway(t);
}

// Looks left at the furniture all the way: only the wall is visible, not the
// end of the corridor.
Rigid3d TwinCorridorsTour(double t, double /*duration*/) {
  static const Way way({{1.6, -0.6}, {20.4, -0.6}}, false);
  constexpr double kThere = 55.0;  // s
  const double share = 0.5 * (1.0 - std::cos(M_PI * t / kThere));
  const Vector2d place = way.At(0.5 * way.length() * share);
  return LookAt(Lift(place, 1.35), Lift(place + Vector2d(0.35, 1.0), 1.1)) *
         Sway(t);
}

// Up one aisle, down the next, and along the wall back to the first.
Rigid3d DepotTour(double t, double /*duration*/) {
  static const Way way = [] {
    std::vector<Vector2d> corners;
    for (int aisle = 0; aisle < kDepotAisles; ++aisle) {
      const double x = kDepotPitch * (aisle - (kDepotAisles - 1) / 2.0);
      const double y = aisle % 2 == 0 ? -8.6 : 8.6;
      corners.emplace_back(x, y);
      corners.emplace_back(x, -y);
    }
    corners.emplace_back(corners.back().x(), -9.4);
    corners.emplace_back(corners.front().x(), -9.4);
    return Way(corners, true);
  }();
  constexpr double kRound = 500.0;  // s
  return LookAhead(way, way.length() * t / kRound, 2.6,
                   75.0 * kRadiansPerDegree, 1.35, 0.15) *
         Sway(t);
}

}  // namespace rgbd_pose
