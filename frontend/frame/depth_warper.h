#pragma once

#include <cstdint>
#include <functional>
#include <opencv2/core.hpp>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Of a thing in a room (1/m): where a pixel's own depth is not at hand.
inline constexpr double kRoomInverseDepth = 0.5;

// Makes depth images as a camera sees them after a small motion (some
// centimetres and degrees): what has to be done to depth that was measured at
// another time than colour. One object serves one thread; its memory is used
// again.
class DepthWarper {
 public:
  // The camera of all frames.
  explicit DepthWarper(const Camera& camera);

  // The depth image (CV_16UC1, in the frame's units, 0: unknown) of a frame
  // from where the motion leads. Each depth is that of one surface: what comes
  // into view from behind another one is unknown. Good until the next call.
  const cv::Mat& Move(const Frame& frame, const Rigid3d& moved_from_measured);

  // The same where every row (px, of the measured image) has a motion of its
  // own.
  using RowMotion = std::function<Rigid3d(double row)>;
  const cv::Mat& Move(const Frame& frame, const RowMotion& moved_from_measured);

 private:
  // How a block of pixels moves. A moved pixel p at depth z was measured at
  // p + turn + shift / z, to first order in the translation, where its depth
  // was stretch * z + advance.
  struct Flow {
    float turn_u, turn_v;    // px
    float shift_u, shift_v;  // px m
    float stretch;
    float advance;  // raw units
  };
  struct Range {
    uint16_t min, max;  // of raw depths; min > max: there are none
  };

  cv::Rect BlockAt(int column, int row) const;
  void FindRanges();
  Flow FlowAt(size_t block, const Rigid3d& measured_from_moved) const;
  Range RangeAround(int column, int row, const Flow& flow) const;
  // All of the block at one depth, as far as its place is concerned.
  void MoveTogether(const cv::Rect& block, const Flow& flow, float u, float v,
                    cv::Mat* out) const;
  // Each pixel by itself: which surface it sees has to be found out.
  void MoveEach(const cv::Rect& block, const Flow& flow, Range range,
                cv::Mat* out) const;
  // The raw depth between pixels of one surface, or the nearest pixel's.
  float Sample(float u, float v) const;

  Camera camera_;
  int columns_, rows_;                    // of blocks
  std::vector<Eigen::Vector3d> rays_;     // of their middles
  std::vector<Eigen::Vector2d> middles_;  // where these are, px
  std::vector<Range> ranges_;             // of their depths
  std::vector<uint16_t> column_min_, column_max_;
  cv::Mat measured_;  // the depth image, 0: none
  cv::Mat moved_;
  std::vector<Rigid3d> measured_from_moved_;  // by row of the measured image
  double depth_scale_ = 1.0;
};

}  // namespace rgbd_pose
