#include "core/inertial/imu_check.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "core/geometry/rigid3.h"
#include "core/util/format.h"
#include "core/util/quantile.h"
#include "core/util/units.h"

namespace rgbd_pose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kGravity = 9.81;  // m/s^2

// A recording that a hand moves measures gravity, within so much of it, in the
// median.
constexpr double kGravityTolerance = 0.3;

// Sensors of cameras and phones measure up to 2,000 degrees per second, 35
// rad/s; in degrees a hand often turns faster than 40 degrees per second.
constexpr double kFastest = 40.0;  // rad/s

// Accelerations are averaged over so long, s: shorter than a hand takes to
// come back, longer than a sensor's noise.
constexpr double kWindow = 0.1;

// Another reading of the gyroscope has to leave at most this part of what it
// leaves as given, and of how much accelerations change; over so many windows.
// (Simulated shaking of 6 m/s^2: 0.64; a robot that flies, whose accelerometer
// shows its thrust, not gravity: 1.08 at the least of all readings.)
constexpr double kClearly = 0.75;
constexpr size_t kFewestWindows = 50;

bool IsGravity(double value, double unit) {
  return std::abs(value / (unit * kGravity) - 1.0) < kGravityTolerance;
}

// The mean accelerations of windows, and the turn (the integral of the
// gyroscope) from the middle of each window to the middle of the next.
struct Windows {
  std::vector<Vector3d> accel;
  std::vector<Vector3d> turn;

  explicit Windows(const std::vector<ImuSample>& samples) {
    Vector3d sum = Vector3d::Zero(), turned = Vector3d::Zero(),
             middle = Vector3d::Zero();
    int count = 0;
    double start = samples.front().stamp;
    bool is_first_half = true;
    for (size_t i = 0; i < samples.size(); ++i) {
      const ImuSample& sample = samples[i];
      if (i > 0) {
        turned += 0.5 * (sample.stamp - samples[i - 1].stamp) *
                  (sample.gyro + samples[i - 1].gyro);
      }
      if (is_first_half && sample.stamp >= start + 0.5 * kWindow) {
        is_first_half = false;
        if (!accel.empty()) turn.push_back(turned - middle);
        middle = turned;
      }
      sum += sample.accel;
      ++count;
      if (sample.stamp < start + kWindow || is_first_half) continue;
      accel.push_back(sum / count);
      sum.setZero();
      count = 0;
      start = sample.stamp;
      is_first_half = true;
    }
    if (turn.size() >= accel.size() && !turn.empty()) {
      turn.resize(accel.empty() ? 0 : accel.size() - 1);
    }
  }

  // How far the accelerations are from those before, turned by `reading` of
  // the gyroscope; a zero matrix: not turned.
  double Misfit(const Matrix3d& reading) const {
    double sum = 0.0;
    for (size_t k = 0; k < turn.size(); ++k) {
      const Rigid3d back =
          Rigid3d::FromRotationVector(-reading * turn[k], Vector3d::Zero());
      // A single acceleration of the hand must not decide.
      sum += std::min((accel[k + 1] - back * accel[k]).norm(), 0.5 * kGravity);
    }
    return sum;
  }
};

// The 48 ways to exchange axes and their signs: v is read as matrix * v.
std::vector<Matrix3d> AxisExchanges() {
  std::vector<Matrix3d> exchanges;
  std::array<int, 3> order = {0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Matrix3d exchange = Matrix3d::Zero();
      for (int row = 0; row < 3; ++row) {
        exchange(row, order[row]) = (signs >> row) % 2 == 1 ? -1.0 : 1.0;
      }
      exchanges.push_back(exchange);
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return exchanges;
}

std::string NameOf(const Matrix3d& exchange) {
  std::string name = "(";
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      if (exchange(row, column) == 0.0) continue;
      name += row > 0 ? ", " : "";
      name += exchange(row, column) < 0.0 ? "-" : "";
      name += "xyz"[column];
    }
  }
  return name + ")";
}

std::string AccelerationError(double median, double gyro_median) {
  struct Unit {
    double size;
    const char* name;
  };
  for (const Unit& unit :
       {Unit{1.0 / kGravity, "g"}, Unit{1000.0 / kGravity, "thousandths of g"},
        Unit{1000.0, "mm/s^2"}}) {
    if (!IsGravity(median, unit.size)) continue;
    return Format(
        "accelerations are %.4g in the median, as gravity is in %s; m/s^2 are "
        "needed: multiply them by %.6g",
        median, unit.name, 1.0 / unit.size);
  }
  if (IsGravity(gyro_median, 1.0)) {
    return "the columns of gyroscope and accelerometer are exchanged: gravity "
           "is in those of the gyroscope";
  }
  return "";
}

// The fastest turn that two samples in a row show: a single one may be a fault
// of the sensor or its cable.
double FastestOf(const std::vector<double>& gyro) {
  double fastest = gyro.size() == 1 ? gyro.front() : 0.0;
  for (size_t i = 1; i < gyro.size(); ++i) {
    fastest = std::max(fastest, std::min(gyro[i - 1], gyro[i]));
  }
  return fastest;
}

std::string DegreesError(double fastest) {
  return Format(
      "the gyroscope turns by up to %.4g, which is in degrees per second; "
      "rad/s "
      "are needed: multiply by %.8g",
      fastest, kRadiansPerDegree);
}

}  // namespace

ImuFindings ExamineImu(const std::vector<ImuSample>& recorded) {
  ImuFindings findings;
  std::vector<ImuSample> samples;
  std::copy_if(recorded.begin(), recorded.end(), std::back_inserter(samples),
               [](const ImuSample& sample) {
                 return sample.gyro.allFinite() && sample.accel.allFinite();
               });
  if (samples.empty()) return findings;
  std::vector<double> accel, gyro;
  for (const ImuSample& sample : samples) {
    accel.push_back(sample.accel.norm());
    gyro.push_back(sample.gyro.norm());
  }
  const double fastest = FastestOf(gyro);
  const double median = Median(accel), gyro_median = Median(gyro);
  if (!IsGravity(median, 1.0)) {
    findings.error = AccelerationError(median, gyro_median);
    if (findings.error.empty()) {
      findings.warning = Format(
          "accelerations are %.4g m/s^2 in the median, gravity is 9.81: their "
          "unit or scale is wrong, or gravity was taken off",
          median);
    }
    return findings;
  }
  if (fastest > kFastest) {
    findings.error = DegreesError(fastest);
    return findings;
  }
  const Windows windows(samples);
  if (windows.turn.size() < kFewestWindows) return findings;
  const double unturned = windows.Misfit(Matrix3d::Zero());
  const double as_given = windows.Misfit(Matrix3d::Identity());
  const double in_degrees =
      windows.Misfit(kRadiansPerDegree * Matrix3d::Identity());
  if (in_degrees < kClearly * std::min(unturned, as_given)) {
    findings.error = DegreesError(fastest);
    return findings;
  }
  double least = kClearly * std::min(unturned, as_given);
  for (const Matrix3d& exchange : AxisExchanges()) {
    const double misfit = windows.Misfit(exchange);
    if (misfit >= least) continue;
    least = misfit;
    findings.warning =
        "the gyroscope's axes do not fit how gravity moves in those of the "
        "accelerometer: (x, y, z) of the accelerometer are " +
        NameOf(exchange) + " of the gyroscope";
  }
  return findings;
}

}  // namespace rgbd_pose
