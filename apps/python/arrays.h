#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A Python array of numbers with up to three dimensions and any memory layout.
// float64 and float32 are read in place; other real numbers are converted.
// Reading needs no GIL; construction and destruction do.
class NumberArray {
 public:
  static constexpr pybind11::ssize_t kAny = -1;

  // Throws InputError with `name` unless it has real numbers of this shape.
  NumberArray(const pybind11::object& object, const std::string& name,
              const std::vector<pybind11::ssize_t>& shape);

  // The size of the first dimension.
  size_t size() const { return size_; }

  double operator()(size_t i, size_t j = 0, size_t k = 0) const {
    const char* at =
        data_ + i * strides_[0] + j * strides_[1] + k * strides_[2];
    return is_float32_ ? Load<float>(at) : Load<double>(at);
  }

 private:
  // The array may be unaligned.
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

// Converts an object to an array. Throws InputError with `name` if it is none.
pybind11::array ToArray(const pybind11::object& object,
                        const std::string& name);

// The rigid motion of a 4 x 4 array. Throws InputError if it is invalid.
Rigid3d RigidFromArray(const pybind11::object& object, const std::string& name);

// The rotation of a 3 x 3 array. Throws InputError if it is none.
Eigen::Quaterniond RotationFromArray(const pybind11::object& object,
                                     const std::string& name);

// A matrix that is stored row by row, as arrays are.
using RowMajorMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

pybind11::array ReadOnly(pybind11::array array);

// A read-only copy of a small matrix.
pybind11::array ArrayFromMatrix(const RowMajorMatrix& matrix);

// Converts a value to Python: motions and matrices to arrays, enums to words,
// everything else as pybind11 does.
pybind11::array ToPython(const Rigid3d& motion);
template <typename T>
decltype(auto) ToPython(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return ToString(value);
  } else if constexpr (std::is_base_of_v<Eigen::MatrixBase<T>, T>) {
    return ArrayFromMatrix(value);
  } else {
    return value;  // a reference
  }
}

// A getter for a list of numbers: a read-only view, which keeps `self` alive.
template <typename Class, auto kMember>
pybind11::array ViewOf(const pybind11::object& self) {
  const auto& values = self.cast<const Class&>().*kMember;
  using T = typename std::decay_t<decltype(values)>::value_type;
  return ReadOnly(pybind11::array(pybind11::dtype::of<T>(), {values.size()}, {},
                                  values.data(), self));
}

// Returns a function that defines a read-only property of a Python class:
//   property(name, what, help)
// `what` is a getter, or a data member for ToPython.
template <typename Class>
auto PropertiesOf(Class* type) {
  return [type](const char* name, const auto& what, const char* help) {
    using What = std::decay_t<decltype(what)>;
    if constexpr (std::is_member_object_pointer_v<What>) {
      using Self = typename Class::type;
      const auto get = [what](const Self& self) -> decltype(auto) {
        return ToPython(self.*what);
      };
      type->def_property_readonly(name, get, help);
    } else {
      type->def_property_readonly(name, what, help);
    }
  };
}

// Paths are bytes here and, as in os.fsdecode, text in Python. A null
// character, where the system would end the path, throws InputError.
std::string PathFrom(const pybind11::object& path);
pybind11::str PathTo(const std::string& path);

// A message as text, also if a path in it is not valid UTF-8.
pybind11::str TextOf(const std::string& message);

// Shows users a remark, for example on a file, as a UserWarning, unless it is
// empty.
void WarnUser(const std::string& remark);

// A trajectory from the path of a TUM text file, or from a pair of timestamps
// (N,) and poses (N, 7) tx ty tz qx qy qz qw or (N, 4, 4). Throws InputError
// with the name of the argument for anything else.
Trajectory TrajectoryFrom(const pybind11::object& object,
                          const std::string& name);

// A pair of timestamps (N,) and poses (N, 4, 4).
pybind11::tuple ArraysFromTrajectory(const Trajectory& trajectory);

}  // namespace rgbd_pose
