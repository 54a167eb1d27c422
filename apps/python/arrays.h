#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <array>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// Numbers that Python gave, in up to three dimensions and of any layout.
// float64 and float32 are read where they are, other real numbers are
// converted. Reading needs no GIL; making and destroying does.
class NumberArray {
 public:
  static constexpr pybind11::ssize_t kAny = -1;

  // Throws InputError, naming the argument, if the object is no array of real
  // numbers or not of that shape.
  NumberArray(const pybind11::object& object, const std::string& name,
              const std::vector<pybind11::ssize_t>& shape);

  // Of the first dimension.
  size_t size() const { return size_; }

  double operator()(size_t i, size_t j = 0, size_t k = 0) const {
    const char* at =
        data_ + i * strides_[0] + j * strides_[1] + k * strides_[2];
    return is_float32_ ? Load<float>(at) : Load<double>(at);
  }

 private:
  // An array need not be aligned.
  template <typename T>
  static T Load(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof(value));
    return value;
  }

  pybind11::array array_;
  const char* data_ = nullptr;
  size_t size_ = 0;
  std::array<pybind11::ssize_t, 3> strides_ = {0, 0, 0};
  bool is_float32_ = false;
};

// An object as an array; throws InputError, naming the argument, if it is
// invalid.
pybind11::array ToArray(const pybind11::object& object,
                        const std::string& name);

// The shape of an array in words, as Python prints it: "(3, 4)".
std::string ShapeInWords(const pybind11::array& array);

// The rigid motion of a 4 x 4 matrix; throws InputError if it is invalid.
Rigid3d RigidFromMatrix(const Eigen::Matrix4d& matrix,
                        const std::string& where);

// The same of a 4 x 4 array.
Rigid3d RigidFromArray(const pybind11::object& object, const std::string& name);

Eigen::Matrix4d MatrixFromRigid(const Rigid3d& motion);

// Takes the right to write from an array.
pybind11::array ReadOnly(pybind11::array array);

// A copy of a small matrix, row by row, not to be written.
pybind11::array ArrayFromMatrix(const Eigen::MatrixXd& matrix);

// A value as Python has it: motions and matrices as arrays, states in words,
// all else as pybind11 does.
inline pybind11::array ToPython(const Rigid3d& motion) {
  return ArrayFromMatrix(MatrixFromRigid(motion));
}
template <typename T>
auto ToPython(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return ToString(value);
  } else if constexpr (std::is_base_of_v<Eigen::MatrixBase<T>, T>) {
    return ArrayFromMatrix(value);
  } else {
    return value;
  }
}

// A property that is a member of what it is bound to.
template <typename Self, typename T>
auto Get(T Self::*member) {
  return [member](const Self& self) { return ToPython(self.*member); };
}

// What an object holds, seen as an array that keeps the object alive; no copy.
template <typename T>
pybind11::array ViewOf(const std::vector<T>& values, pybind11::handle owner) {
  return ReadOnly(pybind11::array(pybind11::dtype::of<T>(), {values.size()}, {},
                                  values.data(), owner));
}

// A path from a string or whatever has one.
std::string PathFrom(const pybind11::object& path);
bool IsPath(const pybind11::object& object);

// A trajectory from the path of a TUM text file or a pair of time stamps (N,)
// and poses (N, 7) tx ty tz qx qy qz qw or (N, 4, 4). Throws InputError, naming
// the argument, for anything else.
Trajectory TrajectoryFrom(const pybind11::object& object,
                          const std::string& name);

// A pair of time stamps (N,) and poses (N, 4, 4).
pybind11::tuple ArraysFromTrajectory(const Trajectory& trajectory);

}  // namespace rgbd_pose
