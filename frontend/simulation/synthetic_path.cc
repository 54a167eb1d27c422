#include "frontend/simulation/synthetic_path.h"

#include <algorithm>
#include <cmath>

#include "core/util/named_values.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

// A camera at `place` that looks at `target`, with a level x axis.
Rigid3d LookAt(const Vector3d& place, const Vector3d& target) {
  Matrix3d world_from_cam;
  world_from_cam.col(2) = (target - place).normalized();
  world_from_cam.col(0) =
      world_from_cam.col(2).cross(Vector3d::UnitZ()).normalized();
  world_from_cam.col(1) = world_from_cam.col(2).cross(world_from_cam.col(0));
  return Rigid3d(Quaterniond(world_from_cam), place);
}

Rigid3d Turn(double angle, const Vector3d& axis) {
  return Rigid3d(Quaterniond(AngleAxisd(angle, axis)), Vector3d::Zero());
}

Rigid3d Shift(const Vector3d& translation) {
  return Rigid3d(Quaterniond::Identity(), translation);
}

Rigid3d Xyz(double t, double /*duration*/) {
  constexpr double kReach = 0.2;  // m
  constexpr double kRound = 5.0;  // s for all three axes
  constexpr double kSway = 1.0 * kRadiansPerDegree;
  const double leg = t / (kRound / 3.0);
  const double whole = std::trunc(leg);
  const int index = static_cast<int>(std::fmod(whole, 6.0));
  const double side = index < 3 ? 1.0 : -1.0;
  Vector3d shift = Vector3d::Zero();
  // A raised cosine starts and stops smoothly.
  shift[index % 3] =
      side * kReach * 0.5 * (1.0 - std::cos(2.0 * M_PI * (leg - whole)));
  const Rigid3d sway = Turn(kSway * std::sin(1.9 * t), Vector3d::UnitX()) *
                       Turn(kSway * std::sin(1.3 * t), Vector3d::UnitY()) *
                       Turn(kSway * std::sin(2.3 * t), Vector3d::UnitZ());
  return LookAt({-1.10, -0.35, 1.35}, {0.6, 0.2, 0.80}) * Shift(shift) * sway;
}

// The angle of a device that moves through stops after `share` (0..1) of the
// time. A leg takes time in proportion to its angle, with cubic ease in and
// out.
template <size_t N>
double ThroughStops(const double (&stops)[N], double share) {
  double way = 0.0;
  for (size_t i = 1; i < N; ++i) way += std::abs(stops[i] - stops[i - 1]);
  double left = std::max(share, 0.0) * way;
  for (size_t i = 1; i < N; ++i) {
    const double leg = std::abs(stops[i] - stops[i - 1]);
    if (left < leg) {
      const double s = left / leg;
      return stops[i - 1] + (stops[i] - stops[i - 1]) * s * s * (3.0 - 2.0 * s);
    }
    left -= leg;
  }
  return stops[N - 1];
}

Rigid3d PanTilt(double t, double duration) {
  constexpr double kPan[] = {0.0, 20.0, -20.0, 0.0};
  constexpr double kTilt[] = {0.0, 12.0, -12.0, 0.0};
  constexpr double kPanShare = 80.0 / (80.0 + 48.0);
  const double share = duration > 0.0 ? std::min(t / duration, 1.0) : 1.0;
  const double pan = ThroughStops(kPan, share / kPanShare);
  const double tilt =
      ThroughStops(kTilt, (share - kPanShare) / (1.0 - kPanShare));
  const Rigid3d world_from_mount =
      LookAt({-1.5, -0.45, 1.25}, {0.6, 0.15, 1.0});
  const Rigid3d head_from_cam = Shift({0.02, -0.06, 0.04});
  return world_from_mount * Turn(pan * kRadiansPerDegree, Vector3d::UnitY()) *
         Turn(tilt * kRadiansPerDegree, Vector3d::UnitX()) * head_from_cam;
}

Rigid3d Circle(double t, double /*duration*/) {
  constexpr double kRadius = 0.3;  // m
  constexpr double kPeriod = 9.0;  // s
  const double angle = 2.0 * M_PI * t / kPeriod;
  const Vector3d centre(-1.10, -0.40, 1.35);
  return LookAt(
      centre + kRadius * Vector3d(std::cos(angle), std::sin(angle), 0),
      {0.8, 0.25, 0.90});
}

struct Wave {
  double amplitude;
  double hz;
  double phase;  // rad
};

template <size_t N>
double Sum(const Wave (&waves)[N], double t) {
  double sum = 0.0;
  for (const Wave& wave : waves) {
    sum += wave.amplitude * std::sin(2.0 * M_PI * wave.hz * t + wave.phase);
  }
  return sum;
}

// Frequencies are multiples of 0.01 Hz: the path repeats after 100 s, and its
// peaks in this time are its overall peaks. The phases are chosen for the first
// five seconds to come close to them.
Rigid3d Handheld(double t, double /*duration*/) {
  // Arm, hand and tremor, in m, then in degrees.
  constexpr Wave kX[] = {
      {0.35, 0.19, 4.3}, {0.044, 0.61, 1.6}, {0.0035, 2.3, 1.0}};
  constexpr Wave kY[] = {
      {0.37, 0.23, 5.5}, {0.040, 0.71, 3.3}, {0.0035, 2.9, 5.9}};
  constexpr Wave kZ[] = {
      {0.12, 0.37, 1.2}, {0.026, 0.89, 4.2}, {0.0035, 2.6, 1.7}};
  constexpr Wave kYaw[] = {
      {17.5, 0.41, 3.1}, {4.0, 1.13, 5.4}, {0.25, 3.1, 4.9}};
  constexpr Wave kPitch[] = {
      {5.6, 0.53, 3.4}, {2.4, 1.27, 4.8}, {0.25, 2.7, 4.7}};
  constexpr Wave kRoll[] = {
      {4.8, 0.47, 0.7}, {2.0, 1.19, 0.9}, {0.25, 3.3, 2.8}};
  Rigid3d world_from_hand = LookAt({-1.10, -0.40, 1.40}, {0.7, 0.15, 0.95});
  world_from_hand.translation += Vector3d(Sum(kX, t), Sum(kY, t), Sum(kZ, t));
  return world_from_hand *
         Turn(Sum(kYaw, t) * kRadiansPerDegree, Vector3d::UnitY()) *
         Turn(Sum(kPitch, t) * kRadiansPerDegree, Vector3d::UnitX()) *
         Turn(Sum(kRoll, t) * kRadiansPerDegree, Vector3d::UnitZ());
}

Rigid3d Still(double /*t*/, double duration) { return Xyz(0.0, duration); }

// Straight on at a walking pace and back, along the camera's axis.
Rigid3d Walk(double t, double /*duration*/) {
  constexpr double kWay = 3.0;    // m
  constexpr double kRound = 8.0;  // s, there and back
  const double x = kWay * 0.5 * (1.0 - std::cos(2.0 * M_PI * t / kRound));
  const double step = 2.0 * M_PI * 1.8 * t;
  return LookAt({-1.10, -0.35, 1.35}, {1.0, -0.25, 1.20}) *
         Shift({0.015 * std::sin(step / 2), 0.02 * std::sin(step), 0.0}) *
         Rigid3d(Quaterniond(AngleAxisd(0.02 * std::sin(step / 2 + 0.4),
                                        Vector3d::UnitZ())),
                 Vector3d(0, 0, x));
}

// Along Xyz, with half turns to the left and back about the vertical.
template <int kDegreesPerSecond>
Rigid3d WhipPan(double t, double duration) {
  constexpr double kRate = kDegreesPerSecond * kRadiansPerDegree;  // rad/s
  constexpr double kSpinUp = 0.1;                  // s, the same to stop
  constexpr double kPan = M_PI / kRate + kSpinUp;  // s
  constexpr double kPeriod = 3.0;                  // s, start to start
  const double pan = std::floor(t / kPeriod);
  const bool is_back = std::fmod(pan, 2.0) != 0.0;
  const double s =
      std::clamp(t - pan * kPeriod - (kPeriod - kPan) / 2.0, 0.0, kPan);
  const double up = std::min(s, kSpinUp);
  const double down = std::max(s - (kPan - kSpinUp), 0.0);
  const double turned =
      kRate * (s - up + (up * up - down * down) / kSpinUp / 2);
  Rigid3d pose = Xyz(t, duration);
  pose.rotation =
      Turn(is_back ? M_PI - turned : turned, Vector3d::UnitZ()).rotation *
      pose.rotation;
  return pose;
}

// Tours: a camera is carried by hand through the scene of the same name.

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
  const Vector3d shift(Sum({{0.010, 0.53, 0.0}}, t),
                       Sum({{0.015, 0.83, 1.0}}, t),
                       Sum({{0.010, 0.41, 2.0}}, t));
  const double pitch = Sum({{0.8 * kRadiansPerDegree, 0.67, 3.0}}, t);
  const double yaw = Sum({{1.2 * kRadiansPerDegree, 0.47, 4.0}}, t);
  const double roll = Sum({{1.0 * kRadiansPerDegree, 0.59, 5.0}}, t);
  return Rigid3d(AngleAxisd(pitch, Vector3d::UnitX()) *
                     AngleAxisd(yaw, Vector3d::UnitY()) *
                     AngleAxisd(roll, Vector3d::UnitZ()),
                 shift);
}

Rigid3d TableTour(double t, double /*duration*/) {
  static const Way way({{-3.1, -2.0}, {3.1, -2.0}, {3.1, 2.0}, {-3.1, 2.0}},
                       true);
  constexpr double kRound = 56.0;  // s
  const Vector2d place = way.At(way.length() * t / kRound);
  // Looks at the desks, from one end to the other, and to both sides of them.
  const double look = 12.0 * kRadiansPerDegree * std::sin(2.0 * M_PI * t / 7.0);
  return LookAt(Lift(place, 1.45), Lift(0.25 * place, 0.85)) *
         Turn(look, Vector3d::UnitY()) * Sway(t);
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
  const double yaw = 12.0 * kRadiansPerDegree * std::sin(2.0 * M_PI * t / 9.5);
  const double s = way.length() * t / kRound;
  const Vector2d place = way.At(s);
  // To the way's point 2.4 m further on, and to both sides of it.
  const Vector2d look =
      Eigen::Rotation2Dd(yaw) * (way.At(s + 2.4) - place).normalized();
  return LookAt(Lift(place, 1.45), Lift(place + look, 1.45 - 0.25)) * Sway(t);
}

// Looks left at the furniture: never sees the end of the corridor.
Rigid3d TwinCorridorsTour(double t, double /*duration*/) {
  static const Way way({{1.6, -0.6}, {20.4, -0.6}}, false);
  constexpr double kThere = 55.0;  // s
  const double share = 0.5 * (1.0 - std::cos(M_PI * t / kThere));
  const Vector2d place = way.At(0.5 * way.length() * share);
  return LookAt(Lift(place, 1.35), Lift(place + Vector2d(0.35, 1.0), 1.1)) *
         Sway(t);
}

constexpr Named<SyntheticPath> kPaths[] = {
    {"xyz", Xyz},
    {"pan_tilt", PanTilt},
    {"circle", Circle},
    {"still", Still},
    {"walk", Walk},
    {"handheld", Handheld},
    {"whip_pan", WhipPan<300>},
    {"whip_pan_fast", WhipPan<600>},
    {"table", TableTour},
    {"two_rooms", TwoRoomsTour},
    {"twin_corridors", TwinCorridorsTour}};

}  // namespace

SyntheticPath FindSyntheticPath(const std::string& name) {
  return RowOf(kPaths, "path", name).value;
}

std::vector<std::string> SyntheticPathNames() { return NamesOf(kPaths); }

}  // namespace rgbd_pose
