#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "core/geometry/camera.h"

namespace rgbd_pose {

// Counts features in square cells of an image; pixels outside are ignored.
class CellCounts {
 public:
  explicit CellCounts(const Camera& camera)
      : columns_(static_cast<int>(camera.width / kCellPx) + 1),
        rows_(static_cast<int>(camera.height / kCellPx) + 1),
        counts_(columns_ * rows_, 0),
        outside_(0) {}

  // Number of cells with at least one feature.
  int num_covered() const {
    return counts_.size() - std::count(counts_.begin(), counts_.end(), 0);
  }

  int& At(const Eigen::Vector2d& pixel) {
    if (!(pixel.x() >= 0.0 && pixel.y() >= 0.0)) return outside_;
    const int column = static_cast<int>(pixel.x() / kCellPx);
    const int row = static_cast<int>(pixel.y() / kCellPx);
    if (column >= columns_ || row >= rows_) return outside_;
    return counts_[row * columns_ + column];
  }

 private:
  // Side of a cell. A cell of a well textured view has about six features.
  static constexpr double kCellPx = 64.0;

  int columns_, rows_;
  std::vector<int> counts_;
  int outside_;
};

}  // namespace rgbd_pose
