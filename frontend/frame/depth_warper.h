#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Typical inverse depth in a room (1/m), used if a pixel's depth is not known.
inline constexpr double kRoomInverseDepth = 0.5;

// Points of an image every kStep px in both directions, row by row.
struct RayGrid {
  static constexpr int kStep = 8;  // px

  // As many columns as blocks of kStep px, with the points in their middle.
  RayGrid(const Camera& camera, int num_rows, double first_row);

  int columns, rows;
  std::vector<Eigen::Vector3d> rays;    // (a, b, 1)
  std::vector<Eigen::Vector2d> pixels;  // their image points
};

// Warps depth images to the view of a camera after a small motion (some
// centimetres and degrees). This aligns depth that was measured at another time
// than colour. Not thread-safe; the object reuses its memory.
class DepthWarper {
 public:
  // The camera of all frames.
  explicit DepthWarper(const Camera& camera);

  // The depth image of a frame (CV_16UC1, in its units, 0: unknown) seen after
  // the motion. Each depth is of one surface; surfaces that come into view from
  // behind other ones are unknown. Valid until the next call.
  const cv::Mat& Move(const Frame& frame, const Rigid3d& moved_from_measured);

  // The same with a separate motion for each row (px) of the measured image.
  using RowMotion = std::function<Rigid3d(double row)>;
  const cv::Mat& Move(const Frame& frame, const RowMotion& moved_from_measured);

 private:
  // The motion of a block of pixels. A moved pixel p at depth z was measured at
  // p + turn + shift / z (to first order in the translation) with the depth
  // stretch * z + advance.
  struct Flow {
    Eigen::Vector2f turn;   // px
    Eigen::Vector2f shift;  // px m
    float stretch;
    float advance;  // raw units
  };
  struct Range {
    uint16_t min, max;  // raw depths; min > max: none
  };

  void FindRanges();
  Flow FlowAt(size_t block, const Rigid3d& measured_from_moved) const;
  Range RangeAround(int column, int row, const Flow& flow) const;
  // Moves all pixels of a block by the same displacement.
  void MoveTogether(const cv::Rect& block, const Flow& flow,
                    const Eigen::Vector2f& displacement);
  // Moves each pixel separately and searches for the surface that it sees.
  void MoveEach(const cv::Rect& block, const Flow& flow, Range range);

  Camera camera_;
  RayGrid blocks_;             // their middles
  std::vector<Range> ranges_;  // of blocks
  std::vector<uint16_t> column_min_, column_max_;
  cv::Mat measured_;  // the depth image; 0: none
  cv::Mat moved_;
  std::vector<Rigid3d> measured_from_moved_;  // by row of the measured image
  double depth_scale_ = 1.0;
};

}  // namespace rgbd_pose
