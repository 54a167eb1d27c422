#include "apps/python/arrays.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/util/input_error.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

// The largest error of the length of a quaternion, as for TUM text, and of R
// R^T.
constexpr double kMaxRotationError = 0.01;

Rigid3d PoseFromRow(const NumberArray& row, size_t i,
                    const std::string& where) {
  const Eigen::Vector3d translation(row(i, 0), row(i, 1), row(i, 2));
  const Eigen::Quaterniond rotation(row(i, 6), row(i, 3), row(i, 4), row(i, 5));
  if (!translation.allFinite() ||
      !(std::abs(rotation.norm() - 1.0) <= kMaxRotationError)) {
    throw InputError(where +
                     ": is not a pose; it needs tx ty tz qx qy qz qw, finite "
                     "and with a quaternion of unit length");
  }
  return Rigid3d(rotation, translation);
}

bool IsRotation(const Eigen::Matrix3d& R) {
  const Eigen::Matrix3d error = R * R.transpose() - Eigen::Matrix3d::Identity();
  return R.allFinite() && error.cwiseAbs().maxCoeff() <= kMaxRotationError &&
         R.determinant() > 0.0;
}

// `element` gives the numbers of a matrix by row and column.
template <typename Element>
Rigid3d PoseFromMatrix(const Element& element, const std::string& where) {
  const Eigen::Matrix4d matrix = Eigen::Matrix4d::NullaryExpr(element);
  const Eigen::Matrix3d R = matrix.topLeftCorner<3, 3>();
  const bool is_rigid = matrix.allFinite() && IsRotation(R) &&
                        matrix.row(3) == Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0);
  if (!is_rigid) {
    throw InputError(where +
                     ": is not a rigid motion; it needs a rotation matrix, a "
                     "translation (m) and a last row 0 0 0 1");
  }
  return Rigid3d(Eigen::Quaterniond(R), matrix.topRightCorner<3, 1>());
}

RowMajorMatrix MatrixFromRigid(const Rigid3d& motion) {
  RowMajorMatrix matrix = RowMajorMatrix::Identity(4, 4);
  matrix.topLeftCorner<3, 3>() = motion.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = motion.translation;
  return matrix;
}

Trajectory FromArrays(const py::object& stamps, const py::object& poses,
                      const std::string& name) {
  const NumberArray times(stamps, name + "[0]", {NumberArray::kAny});
  const bool are_matrices = ToArray(poses, name + "[1]").ndim() == 3;
  const NumberArray numbers(
      poses, name + "[1]",
      are_matrices ? std::vector<py::ssize_t>{NumberArray::kAny, 4, 4}
                   : std::vector<py::ssize_t>{NumberArray::kAny, 7});
  if (times.size() != numbers.size()) {
    throw InputError(name + ": " + std::to_string(times.size()) +
                     " time stamps for " + std::to_string(numbers.size()) +
                     " poses; it needs one for each");
  }
  Trajectory trajectory;
  for (size_t i = 0; i < times.size(); ++i) {
    const std::string index = "[" + std::to_string(i) + "]";
    if (!std::isfinite(times(i)) ||
        (i > 0 && times(i) <= trajectory.back().timestamp)) {
      throw InputError(name + "[0]" + index +
                       ": is not finite or not after the previous time stamp; "
                       "sort the poses by time and remove duplicates");
    }
    const std::string where = name + "[1]" + index;
    const auto element = [&](int j, int k) { return numbers(i, j, k); };
    trajectory.push_back({times(i), are_matrices
                                        ? PoseFromMatrix(element, where)
                                        : PoseFromRow(numbers, i, where)});
  }
  return trajectory;
}

}  // namespace

NumberArray::NumberArray(const py::object& object, const std::string& name,
                         const std::vector<py::ssize_t>& shape)
    : array_(ToArray(object, name)) {
  const char kind = array_.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u') {
    throw InputError(name + ": holds " + std::string(py::str(array_.dtype())) +
                     "; it needs real numbers, such as float64");
  }
  bool fits = shape.size() == static_cast<size_t>(array_.ndim());
  for (size_t i = 0; fits && i < shape.size(); ++i) {
    fits = shape[i] == kAny || shape[i] == array_.shape(i);
  }
  if (!fits) {
    std::string needed;
    for (const py::ssize_t side : shape) {
      needed += (needed.empty() ? "(" : ", ") +
                (side == kAny ? "N" : std::to_string(side));
    }
    needed += shape.size() == 1 ? ",)" : ")";
    throw InputError(name + ": has shape " +
                     std::string(py::str(array_.attr("shape"))) +
                     "; it needs " + needed);
  }
  is_float32_ = py::isinstance<py::array_t<float>>(array_);
  if (!is_float32_ && !py::isinstance<py::array_t<double>>(array_)) {
    array_ = py::array_t<double, py::array::forcecast>::ensure(array_);
  }
  data_ = static_cast<const char*>(array_.data());
  size_ = array_.shape(0);
  for (size_t i = 0; i < shape.size(); ++i) strides_[i] = array_.strides(i);
}

py::array ToArray(const py::object& object, const std::string& name) {
  py::array array = py::array::ensure(object);
  if (!array) throw InputError(name + ": is not an array of numbers");
  return array;
}

Rigid3d RigidFromArray(const py::object& object, const std::string& name) {
  const NumberArray numbers(object, name, {4, 4});
  return PoseFromMatrix([&](int i, int j) { return numbers(i, j); }, name);
}

Eigen::Quaterniond RotationFromArray(const py::object& object,
                                     const std::string& name) {
  const NumberArray numbers(object, name, {3, 3});
  const Eigen::Matrix3d R =
      Eigen::Matrix3d::NullaryExpr([&](int i, int j) { return numbers(i, j); });
  if (!IsRotation(R)) throw InputError(name + ": is not a rotation matrix");
  return Eigen::Quaterniond(R).normalized();
}

py::array ReadOnly(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

py::array ArrayFromMatrix(const RowMajorMatrix& matrix) {
  return ReadOnly(
      py::array_t<double>({matrix.rows(), matrix.cols()}, matrix.data()));
}

py::array ToPython(const Rigid3d& motion) {
  return ArrayFromMatrix(MatrixFromRigid(motion));
}

std::string PathFrom(const py::object& path) {
  auto bytes =
      py::module_::import("os").attr("fsencode")(path).cast<std::string>();
  if (bytes.find('\0') != std::string::npos) {
    throw InputError("path " + py::repr(path).cast<std::string>() +
                     ": has a null character, which no path has");
  }
  return bytes;
}

py::str PathTo(const std::string& path) {
  return py::module_::import("os").attr("fsdecode")(py::bytes(path));
}

py::str TextOf(const std::string& message) {
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeUTF8(
      message.data(), static_cast<py::ssize_t>(message.size()), "replace"));
}

void WarnUser(const std::string& remark) {
  if (remark.empty()) return;
  const py::str text = TextOf(remark);
  if (PyErr_WarnFormat(PyExc_UserWarning, 1, "%U", text.ptr()) != 0) {
    throw py::error_already_set();  // users may make warnings errors
  }
}

Trajectory TrajectoryFrom(const py::object& object, const std::string& name) {
  if (py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object) ||
      py::hasattr(object, "__fspath__")) {
    std::vector<std::string> remarks;
    Trajectory trajectory = ReadTrajectory(PathFrom(object), &remarks);
    for (const std::string& remark : remarks) WarnUser(remark);
    return trajectory;
  }
  if (!py::isinstance<py::sequence>(object) || py::len(object) != 2) {
    throw InputError(name +
                     ": must be the path of a trajectory or a pair of time "
                     "stamps (N,) and poses (N, 7) or (N, 4, 4)");
  }
  const py::sequence pair = object;
  return FromArrays(pair[0], pair[1], name);
}

py::tuple ArraysFromTrajectory(const Trajectory& trajectory) {
  const auto size = static_cast<py::ssize_t>(trajectory.size());
  py::array_t<double> stamps(size);
  py::array_t<double> poses({size, py::ssize_t{4}, py::ssize_t{4}});
  double* to = poses.mutable_data();
  for (py::ssize_t i = 0; i < size; ++i, to += 16) {
    stamps.mutable_at(i) = trajectory[i].timestamp;
    std::copy_n(MatrixFromRigid(trajectory[i].world_from_cam).data(), 16, to);
  }
  return py::make_tuple(ReadOnly(stamps), ReadOnly(poses));
}

}  // namespace rgbd_pose
