#include "frontend/tracking/carried_region.h"

#include <algorithm>

namespace rgbd_pose {
namespace {

// Side of a cell, px.
constexpr int kCellPx = 40;

// A cell is left out after this many frames in which at least so many of its
// features, and most of them, stood still.
constexpr int kStillFrames = 5;
constexpr int kMinFeatures = 2;

// It is looked at again after 10 s at 30 frames a second.
constexpr int kForgetAfter = 300;

}  // namespace

void CarriedRegion::Learn(const cv::Size& image,
                          const std::vector<Vote>& votes) {
  columns_ = (image.width - 1) / kCellPx + 1;
  const int rows = (image.height - 1) / kCellPx + 1;
  cells_.resize(static_cast<size_t>(columns_) * rows);
  std::vector<int> still(cells_.size()), moving(cells_.size());
  for (const Vote& vote : votes) {
    const int column = static_cast<int>(vote.at.x) / kCellPx;
    const int row = static_cast<int>(vote.at.y) / kCellPx;
    if (column < 0 || row < 0 || column >= columns_ || row >= rows) continue;
    ++(vote.is_still ? still : moving)[row * columns_ + column];
  }
  num_carried_ = 0;
  for (size_t i = 0; i < cells_.size(); ++i) {
    Cell& cell = cells_[i];
    if (cell.forget_in > 0) --cell.forget_in;
    if (moving[i] > 0 && moving[i] >= still[i]) {
      cell.still_frames = 0;
    } else if (still[i] >= kMinFeatures &&
               ++cell.still_frames >= kStillFrames) {
      cell.forget_in = kForgetAfter;
      cell.still_frames = kStillFrames - 1;  // one more frame confirms it later
    }
    num_carried_ += cell.forget_in > 0;
  }
}

cv::Mat CarriedRegion::WithoutRegion(const cv::Mat& depth) const {
  cv::Mat without = depth.clone();
  const cv::Rect image({0, 0}, depth.size());
  for (size_t i = 0; i < cells_.size(); ++i) {
    if (cells_[i].forget_in == 0) continue;
    const int at = static_cast<int>(i);
    const cv::Rect cell(at % columns_ * kCellPx, at / columns_ * kCellPx,
                        kCellPx, kCellPx);
    without(cell & image).setTo(0);
  }
  return without;
}

}  // namespace rgbd_pose
