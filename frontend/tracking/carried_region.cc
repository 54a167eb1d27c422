#include "frontend/tracking/carried_region.h"

#include <Eigen/Core>
#include <cmath>

#include "frontend/frame/observe.h"

namespace rgbd_pose {
namespace {

// Side of a cell, px.
constexpr int kCellPx = 40;

// A cell is left out after this many frames in which it stood still although
// the motion should have moved it by this much (px).
constexpr int kStillFrames = 5;
constexpr double kMinFlowPx = 4.0;

// It is looked at again after 10 s at 30 frames a second.
constexpr int kForgetAfter = 300;

// Correlation of the gray levels of a cell in two images. An edge along which
// the camera moves is the same where it was and where it should be: it tells
// nothing.
constexpr double kSame = 0.95;
constexpr double kDifferent = 0.8;
// A cell with less contrast (standard deviation of gray levels) tells nothing.
constexpr double kMinContrast = 8.0;

// Returns the correlation of a cell in two images, in the second one moved by
// `shift`; 0 without contrast.
double Correlation(const cv::Mat& a, const cv::Mat& b, const cv::Rect& cell,
                   const cv::Point& shift) {
  constexpr int kStep = 2;  // px
  double n = 0.0, sum_a = 0.0, sum_b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0;
  for (int v = cell.y; v < cell.y + cell.height; v += kStep) {
    const uint8_t* const row_a = a.ptr<uint8_t>(v);
    const uint8_t* const row_b = b.ptr<uint8_t>(v + shift.y) + shift.x;
    for (int u = cell.x; u < cell.x + cell.width; u += kStep) {
      const double x = row_a[u], y = row_b[u];
      n += 1.0, sum_a += x, sum_b += y, aa += x * x, bb += y * y, ab += x * y;
    }
  }
  const double variance_a = aa / n - sum_a / n * (sum_a / n);
  const double variance_b = bb / n - sum_b / n * (sum_b / n);
  const double least = kMinContrast * kMinContrast;
  if (!(variance_a > least && variance_b > least)) return 0.0;
  return (ab / n - sum_a / n * (sum_b / n)) /
         std::sqrt(variance_a * variance_b);
}

}  // namespace

void CarriedRegion::Learn(const Frame& ref, const Frame& cur,
                          const Camera& camera, const Rigid3d& cur_from_ref) {
  columns_ = (cur.gray.cols - 1) / kCellPx + 1;
  const int rows = (cur.gray.rows - 1) / kCellPx + 1;
  cells_.resize(static_cast<size_t>(columns_) * rows);
  const cv::Rect image({0, 0}, cur.gray.size());
  const FrameTiming timing = cur.Timing();
  num_carried_ = 0;
  for (int i = 0; i < static_cast<int>(cells_.size()); ++i) {
    Cell& cell = cells_[i];
    if (cell.forget_in > 0) --cell.forget_in;
    num_carried_ += cell.forget_in > 0;
    const cv::Rect place = cv::Rect(i % columns_ * kCellPx,
                                    i / columns_ * kCellPx, kCellPx, kCellPx) &
                           image;
    const Eigen::Vector2d middle(place.x + place.width / 2,
                                 place.y + place.height / 2);
    const double depth =
        ref.DepthAt(static_cast<int>(middle.x()), static_cast<int>(middle.y()));
    if (depth == 0.0) continue;
    const Eigen::Vector3d point =
        cur_from_ref * camera.Unproject(middle, depth);
    if (!(point.z() > 0.0)) continue;
    const Eigen::Vector2d moved = ImagePoint(camera, timing, point);
    if (!((moved - middle).norm() > kMinFlowPx)) continue;
    const cv::Point shift(
        static_cast<int>(std::lround(moved.x() - middle.x())),
        static_cast<int>(std::lround(moved.y() - middle.y())));
    if (((place + shift) & image) != place + shift) continue;
    const double as_still = Correlation(ref.gray, cur.gray, place, {0, 0});
    const double as_moved = Correlation(ref.gray, cur.gray, place, shift);
    if (as_still > kSame && as_moved < kDifferent) {
      if (++cell.still_frames < kStillFrames) continue;
      num_carried_ += cell.forget_in == 0;
      cell.forget_in = kForgetAfter;
    } else if (as_moved > as_still) {
      cell.still_frames = 0;
    }
  }
}

cv::Mat CarriedRegion::WithoutRegion(const cv::Mat& depth) const {
  cv::Mat without = depth.clone();
  const cv::Rect image({0, 0}, depth.size());
  for (int i = 0; i < static_cast<int>(cells_.size()); ++i) {
    if (cells_[i].forget_in == 0) continue;
    const cv::Rect cell(i % columns_ * kCellPx, i / columns_ * kCellPx, kCellPx,
                        kCellPx);
    without(cell & image).setTo(0);
  }
  return without;
}

}  // namespace rgbd_pose
