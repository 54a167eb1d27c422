#include "frontend/frame/frame_rectifier.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace rgbd_pose {

FrameRectifier::FrameRectifier(const Camera& camera)
    : camera_(camera),
      mover_(camera),
      nodes_(camera, (camera.height + RayGrid::kStep - 1) / RayGrid::kStep + 1,
             0.0) {}

Frame FrameRectifier::Rectify(const Frame& frame) {
  return Rectify(frame, Rigid3d());
}

Frame FrameRectifier::Rectify(const Frame& frame,
                              const Rigid3d& target_from_stamp) {
  const FrameTiming timing = frame.Timing();
  if (timing.IsOneMoment()) return frame;
  const Rigid3d target_from_middle =
      target_from_stamp *
      timing.twist.MotionDuring(timing.color.offset).Inverse();
  Frame rectified = frame;
  rectified.depth_delay = 0.0;
  rectified.depth_shutter = Shutter();
  rectified.color_shutter = {0.0, 0.0, frame.color_shutter.is_known};
  const Twist twist = timing.twist.After(timing.color.offset);
  const auto target_from_measured = [&](double row) {
    const double time =
        timing.depth.RowTime(row, camera_.height) - timing.color.offset;
    return target_from_middle * twist.MotionBack(time);
  };
  rectified.depth = mover_.Move(frame, target_from_measured).clone();
  MakeFlows(frame, target_from_middle);
  MakeMaps(rectified.depth, frame.depth_scale);
  const auto resample = [this](const cv::Mat& image) {
    cv::Mat moved;
    if (image.empty()) return moved;
    cv::remap(image, moved, map_u_, map_v_, cv::INTER_LINEAR,
              cv::BORDER_REPLICATE);
    return moved;
  };
  rectified.gray = resample(frame.gray);
  rectified.color = resample(frame.color);
  return rectified;
}

void FrameRectifier::MakeFlows(const Frame& frame,
                               const Rigid3d& target_from_middle) {
  const FrameTiming timing = frame.Timing();
  const Rigid3d middle_from_target = target_from_middle.Inverse();
  const Twist in_the_middle = timing.twist.After(timing.color.offset);
  const Eigen::Matrix3d turned = middle_from_target.rotation.toRotationMatrix();
  // The image point of a target ray at an inverse depth, seen `seconds` after
  // the exposure of the middle row.
  const auto see = [&](const Eigen::Vector3d& ray, double inverse_depth,
                       double seconds) {
    Twist twist = in_the_middle;
    twist.linear *= inverse_depth;
    twist.linear_acceleration *= inverse_depth;
    return camera_.Project(twist.MovedPoint(
        turned * ray + inverse_depth * middle_from_target.translation,
        seconds));
  };
  flows_.resize(nodes_.rays.size());
  for (size_t i = 0; i < flows_.size(); ++i) {
    // The time depends on the row, and the row on the time: iterate.
    Eigen::Vector2d near = nodes_.pixels[i];
    double time = 0.0;
    for (int step = 0; step < 2; ++step) {
      time =
          timing.color.RowTime(near.y(), camera_.height) - timing.color.offset;
      near = see(nodes_.rays[i], kRoomInverseDepth, time);
    }
    const Eigen::Vector2d far = see(nodes_.rays[i], 0.0, time);
    flows_[i] = {(far - nodes_.pixels[i]).cast<float>(),
                 ((near - far) / kRoomInverseDepth).cast<float>()};
  }
}

// Pixels with the same motion use their mean depth. At an edge, part of the
// background moves with the foreground, as in a patch around a corner.
void FrameRectifier::MakeMaps(const cv::Mat& depth, double depth_scale) {
  constexpr int kStep = RayGrid::kStep;
  map_u_.create(depth.size(), CV_32F);
  map_v_.create(depth.size(), CV_32F);
  for (int v = 0; v < depth.rows; ++v) {
    const Flow* const above =
        &flows_[static_cast<size_t>(v / kStep) * nodes_.columns];
    const Flow* const below = above + nodes_.columns;
    const float down = static_cast<float>(v % kStep) / kStep;
    const auto* const raw = depth.ptr<uint16_t>(v);
    float* const to_u = map_u_.ptr<float>(v);
    float* const to_v = map_v_.ptr<float>(v);
    float inverse_depth = kRoomInverseDepth;  // of the last valid depth
    for (int column = 0; column < nodes_.columns; ++column) {
      const int first = column * kStep;
      const int end = std::min(first + kStep, depth.cols);
      int sum = 0, count = 0;
      for (int u = first; u < end; ++u) {
        sum += raw[u];
        count += raw[u] != 0;
      }
      if (count > 0) {
        inverse_depth = static_cast<float>(count * depth_scale / sum);
      }
      const Flow& top = above[column];
      const Flow& bottom = below[column];
      const Eigen::Vector2f from = top.turn + inverse_depth * top.shift;
      const Eigen::Vector2f to = bottom.turn + inverse_depth * bottom.shift;
      const Eigen::Vector2f flow = from + down * (to - from);
      for (int u = first; u < end; ++u) {
        to_u[u] = static_cast<float>(u) + flow[0];
        to_v[u] = static_cast<float>(v) + flow[1];
      }
    }
  }
}

}  // namespace rgbd_pose
