#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <cmath>
#include <optional>

namespace rgbd_pose {

// The plane of a surface in a depth image: its inverse depth (1/m) is linear
// in the image.
struct InverseDepthPlane {
  double middle = 0.0;                              // 1/m
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();  // 1/m per step of the grid
  // The standard deviation in the middle, as a multiple of that of a complete
  // grid.
  double relative_sigma = 1.0;

  // `column`, `row`: from the middle, in steps of the grid.
  double At(double column, double row) const {
    return middle + slope.x() * column + slope.y() * row;
  }
};

// Fits the plane by least squares to those pixels of a grid that have a depth.
// `kSide`: the number of columns and rows, odd.
template <int kSide>
class InverseDepthGrid {
 public:
  // Adds the pixel at `column` and `row` from the middle.
  void Add(int column, int row, double inverse_depth) {
    ++count_;
    columns_ += column;
    rows_ += row;
    column_squares_ += column * column;
    row_squares_ += row * row;
    products_ += column * row;
    sum_ += inverse_depth;
    sum_by_column_ += column * inverse_depth;
    sum_by_row_ += row * inverse_depth;
  }

  // The number of pixels so far.
  int count() const { return count_; }

  // Returns nothing if fewer than `min_count` pixels have a depth; that must be
  // more than fit into one line.
  std::optional<InverseDepthPlane> Fit(int min_count) const {
    constexpr int kAll = kSide * kSide;
    if (count_ < min_count) return std::nullopt;
    if (count_ == kAll) {
      const double squares = column_squares_;
      return InverseDepthPlane{
          sum_ / kAll, {sum_by_column_ / squares, sum_by_row_ / squares}, 1.0};
    }
    Eigen::Matrix3d hessian;
    hessian << count_, columns_, rows_,        //
        columns_, column_squares_, products_,  //
        rows_, products_, row_squares_;
    const Eigen::Matrix3d covariance = hessian.inverse();
    const Eigen::Vector3d plane =
        covariance * Eigen::Vector3d(sum_, sum_by_column_, sum_by_row_);
    return InverseDepthPlane{plane[0], plane.tail<2>(),
                             std::sqrt(kAll * covariance(0, 0))};
  }

 private:
  int count_ = 0, columns_ = 0, rows_ = 0;
  int column_squares_ = 0, row_squares_ = 0, products_ = 0;
  double sum_ = 0.0, sum_by_column_ = 0.0, sum_by_row_ = 0.0;
};

}  // namespace rgbd_pose
