#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "apps/python/arrays.h"
#include "apps/python/bindings.h"
#include "apps/python/factor_arguments.h"
#include "apps/python/released_gil.h"
#include "apps/python/tracker_bindings.h"
#include "core/inertial/imu_buffer.h"
#include "core/inertial/imu_sample.h"
#include "core/inertial/preintegration.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// The samples of an array that an interval needs: a recording has many more.
// All of them if they do not cover it, for a message with how far they reach.
std::vector<ImuSample> SamplesAround(const py::object& object, double start,
                                     double end) {
  const py::array array = ToArray(object, "samples");
  const NumberArray rows(array, "samples", {NumberArray::kAny, 7});
  size_t first = 0, last = 0;
  for (size_t i = 1; i < rows.size(); ++i) {
    if (!(rows(i, 0) > rows(i - 1, 0))) {
      throw InputError("samples[" + std::to_string(i) +
                       "]: its stamp is not finite or not after the previous "
                       "one; sort samples by time and remove duplicates");
    }
    if (rows(i, 0) <= start) first = i;
    if (rows(i - 1, 0) < end) last = i;
  }
  if (rows.size() == 0 || start < rows(0) || rows(rows.size() - 1) < end) {
    return ImuSamplesFrom(array);
  }
  return ImuSamplesFrom(array[py::slice(first, last + 1, 1)]);
}

PreintegratedMotion FromSamples(const py::object& samples, double start,
                                double end, const py::object& bias,
                                const ImuNoise& noise, double max_gap) {
  const std::vector<ImuSample> needed = SamplesAround(samples, start, end);
  const ImuBiasVector at = VectorFrom<6>(bias, "bias");
  const ReleasedGil no_gil;
  ImuBuffer buffer(max_gap);
  for (const ImuSample& sample : needed) buffer.Add(sample);
  return Preintegrate(buffer.Between(start, end), at, noise);
}

// A getter for a vector, as an array (N,).
template <auto kMember>
py::object VectorOf(const PreintegratedMotion& self) {
  return ArrayFromMatrix(self.*kMember).attr("ravel")();
}

std::string InWords(const PreintegratedMotion& self) {
  return Format("Preintegration(%.6g s: %.3g rad, %.3g m/s, %.3g m)",
                self.seconds, Eigen::AngleAxisd(self.start_from_end).angle(),
                self.v.norm(), self.p.norm());
}

}  // namespace

void BindPreintegration(py::module_* module) {
  using Motion = PreintegratedMotion;
  py::class_<Motion> motion(*module, "Preintegration", R"(
Samples of an inertial sensor, summed up from a start to an end: how the sensor
moved, in the axes that it had at the start, whatever its pose and velocity are.
For poses world_from_sensor, R and p, velocities v and gravity g in the world,

    start_from_end = R_start.T @ R_end
    velocity = R_start.T @ (v_end - v_start - g * seconds)
    position = R_start.T @ (p_end - p_start - v_start * seconds
                            - g * seconds**2 / 2))");
  const ImuNoise noise;
  motion.def(py::init([](const py::object& samples, double start, double end,
                         const py::object& bias, double gyro, double accel,
                         double gyro_walk, double accel_walk, double max_gap) {
               return FromSamples(samples, start, end, bias,
                                  {gyro, accel, gyro_walk, accel_walk},
                                  max_gap);
             }),
             py::arg("samples"), py::arg("start"), py::arg("end"),
             py::arg("bias") = py::make_tuple(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
             py::kw_only(), py::arg("gyro") = noise.gyro_density,
             py::arg("accel") = noise.accel_density,
             py::arg("gyro_walk") = noise.gyro_walk,
             py::arg("accel_walk") = noise.accel_walk,
             py::arg("max_gap") = ImuBuffer::kMaxGap, R"(
samples: (N, 7) as Recording.imu() has them, in order of their stamps: stamp (s),
    angular velocity (rad/s), acceleration as it is measured (m/s^2).
start, end: by the clock of the sensor, s. Samples are linear in between.
bias: (6,) that is taken off the samples: rad/s, m/s^2.
gyro, accel, gyro_walk, accel_walk: densities of the noise and of the random
    walks of the biases (rad/s, m/s^2, rad/s^2, m/s^3 per sqrt(Hz)), named as
    in Recording.imu_calibration()["noise"]; of a consumer sensor by default.
max_gap: longest time between two samples, s.

Raises InputError for samples that are not finite, out of order, have a gap in
the interval or do not cover it. The GIL is released.)");
  const auto property = PropertiesOf(&motion);
  property("seconds", &Motion::seconds, "from the start to the end, s");
  property(
      "start_from_end",
      [](const Motion& self) {
        return ArrayFromMatrix(self.start_from_end.toRotationMatrix());
      },
      "(3, 3) turns the axes at the end into those at the start");
  property("velocity", &VectorOf<&Motion::v>,
           "(3,) by which it changed, without gravity, m/s");
  property("position", &VectorOf<&Motion::p>,
           "(3,) by which it changed, without gravity and the velocity at the "
           "start, m");
  property("bias", &VectorOf<&Motion::bias>,
           "(6,) that was taken off the samples: rad/s, m/s^2");
  property("by_bias", &Motion::by_bias,
           "(9, 6) derivatives of [omega velocity position] by the bias; omega "
           "(rad) turns\nthe sensor at the end about its own axes");
  property("covariance", &Motion::covariance,
           "(15, 15) of [omega velocity position] and of how much the bias "
           "changes until the\nend, rad, m/s, m, rad/s, m/s^2");
  motion.def("__repr__", &InWords);
}

}  // namespace rgbd_pose
