#include "benchmarks/frame_trackers.h"

#include <Eigen/Geometry>
#include <limits>
#include <opencv2/core/eigen.hpp>

#include "frontend/settings/settings.h"

#ifdef RGBD_POSE_HAS_OPENCV_RGBD
#include <opencv2/rgbd.hpp>
#endif
#ifdef RGBD_POSE_HAS_OPEN3D
#include "benchmarks/open3d_tracker.h"
#endif

namespace rgbd_pose {
namespace {

OdometrySettings TrackedBy(const char* tracker) {
  OdometrySettings settings;
  settings.tracker = tracker;
  return settings;
}

class OurTracker : public FrameTracker {
 public:
  OurTracker(const char* tracker, const RgbdCamera& camera)
      : odometry_(MakeOdometry(TrackedBy(tracker), camera)) {}

  std::optional<Rigid3d> Track(const BenchmarkFrame& frame) override {
    const TrackedFrame tracked = odometry_.Track(frame.frame);
    if (tracked.status == TrackingStatus::kLost) return std::nullopt;
    return tracked.world_from_cam;
  }

 private:
  Odometry odometry_;
};

#ifdef RGBD_POSE_HAS_OPENCV_RGBD

cv::Mat MatrixOf(const Camera& c) {
  return cv::Mat(cv::Matx33f(c.fx, 0, c.cx, 0, c.fy, c.cy, 0, 0, 1));
}

template <typename CvOdometry>
class OpenCvTracker : public FrameTracker {
 public:
  explicit OpenCvTracker(const RgbdCamera& rgbd)
      : odometry_(CvOdometry::create(MatrixOf(rgbd.camera))) {}

  std::optional<Rigid3d> Track(const BenchmarkFrame& frame) override {
    auto cur = cv::rgbd::OdometryFrame::create(frame.frame.gray, frame.depth_m);
    bool tracked = true;
    if (prev_ != nullptr) {
      cv::Mat prev_from_cur;
      tracked = odometry_->compute(cur, prev_, prev_from_cur);
      if (tracked) {
        Eigen::Matrix4d motion;
        cv::cv2eigen(prev_from_cur, motion);
        const Eigen::Matrix3d R = motion.topLeftCorner<3, 3>();
        world_from_cam_ =
            world_from_cam_ *
            Rigid3d(Eigen::Quaterniond(R), motion.topRightCorner<3, 1>());
      }
    }
    prev_ = cur;
    if (!tracked) return std::nullopt;
    return world_from_cam_;
  }

 private:
  cv::Ptr<CvOdometry> odometry_;
  cv::Ptr<cv::rgbd::OdometryFrame> prev_;
  Rigid3d world_from_cam_;
};

#endif

std::unique_ptr<FrameTracker> MakeByFeatures(const RgbdCamera& camera) {
  return std::make_unique<OurTracker>("features", camera);
}
std::unique_ptr<FrameTracker> MakeDirect(const RgbdCamera& camera) {
  return std::make_unique<OurTracker>("direct", camera);
}
std::unique_ptr<FrameTracker> MakeHybrid(const RgbdCamera& camera) {
  return std::make_unique<OurTracker>("hybrid", camera);
}

template <typename Tracker>
std::unique_ptr<FrameTracker> Make(const RgbdCamera& camera) {
  return std::make_unique<Tracker>(camera);
}

}  // namespace

BenchmarkFrame::BenchmarkFrame(const Frame& images) : frame(images) {
  frame.depth.convertTo(depth_m, CV_32FC1, 1.0 / frame.depth_scale);
  const cv::Mat missing = (frame.depth == 0) | (frame.depth == Frame::kNoDepth);
  depth_m.setTo(std::numeric_limits<float>::quiet_NaN(), missing);
}

std::vector<FrameTrackerType> FrameTrackerTypes() {
  return {
      {"rgbd_pose", MakeByFeatures},
      {"rgbd_pose_direct", MakeDirect},
      {"rgbd_pose_hybrid", MakeHybrid},
#ifdef RGBD_POSE_HAS_OPENCV_RGBD
      {"opencv_rgbd", Make<OpenCvTracker<cv::rgbd::RgbdOdometry>>},
      {"opencv_icp", Make<OpenCvTracker<cv::rgbd::ICPOdometry>>},
      {"opencv_rgbdicp", Make<OpenCvTracker<cv::rgbd::RgbdICPOdometry>>},
#endif
#ifdef RGBD_POSE_HAS_OPEN3D
      {"open3d_hybrid", MakeOpen3dHybrid},
#endif
  };
}

}  // namespace rgbd_pose
