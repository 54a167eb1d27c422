#include "apps/python/trajectory_arrays.h"

#include <pybind11/numpy.h>

#include <algorithm>
#include <cmath>

#include "apps/python/arrays.h"
#include "core/util/input_error.h"

namespace py = pybind11;

namespace rgbd_pose {
namespace {

constexpr double kMaxQuaternionError = 0.01;  // as of TUM text

Rigid3d PoseFromRow(const NumberArray& row, size_t i,
                    const std::string& where) {
  const Eigen::Vector3d translation(row(i, 0), row(i, 1), row(i, 2));
  const Eigen::Quaterniond rotation(row(i, 6), row(i, 3), row(i, 4), row(i, 5));
  if (!translation.allFinite() ||
      !(std::abs(rotation.norm() - 1.0) <= kMaxQuaternionError)) {
    throw InputError(where +
                     ": is no pose; it needs tx ty tz qx qy qz qw, finite and "
                     "with a quaternion of unit length");
  }
  return Rigid3d(rotation, translation);
}

Rigid3d PoseFromMatrix(const NumberArray& poses, size_t i,
                       const std::string& where) {
  Eigen::Matrix4d matrix;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      matrix(row, column) = poses(i, row, column);
    }
  }
  return RigidFromMatrix(matrix, where);
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
                       ": is not after the time stamp before it; sort the "
                       "poses by time and keep one a time stamp");
    }
    const std::string where = name + "[1]" + index;
    trajectory.push_back({times(i), are_matrices
                                        ? PoseFromMatrix(numbers, i, where)
                                        : PoseFromRow(numbers, i, where)});
  }
  return trajectory;
}

}  // namespace

Trajectory TrajectoryFrom(const py::object& object, const std::string& name) {
  if (IsPath(object)) return ReadTrajectory(PathFrom(object));
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
    const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix =
        MatrixFromRigid(trajectory[i].world_from_cam);
    std::copy_n(matrix.data(), 16, to);
  }
  return py::make_tuple(ReadOnly(stamps), ReadOnly(poses));
}

}  // namespace rgbd_pose
