#include "benchmarks/open3d_tracker.h"

#include <open3d/geometry/RGBDImage.h>
#include <open3d/pipelines/odometry/Odometry.h>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

namespace rgbd_pose {
namespace {

namespace geometry = open3d::geometry;
namespace odometry = open3d::pipelines::odometry;

geometry::Image FloatImage(const cv::Mat& image, double scale) {
  geometry::Image result;
  result.Prepare(image.cols, image.rows, 1, sizeof(float));
  cv::Mat view(image.size(), CV_32FC1, result.data_.data());
  image.convertTo(view, CV_32FC1, scale);
  return result;
}

class Open3dHybrid final : public FrameTracker {
 public:
  explicit Open3dHybrid(const Camera& camera)
      : intrinsics_(camera.width, camera.height, camera.fx, camera.fy,
                    camera.cx, camera.cy) {}

  std::optional<Rigid3d> Track(const BenchmarkFrame& frame) override {
    auto cur = std::make_unique<geometry::RGBDImage>(
        FloatImage(frame.frame.gray, 1.0 / 255.0),
        FloatImage(frame.frame.depth, 1.0 / frame.frame.depth_scale));
    bool tracked = true;
    if (prev_ != nullptr) {
      Eigen::Matrix4d prev_from_cur;
      Eigen::Matrix6d information;
      std::tie(tracked, prev_from_cur, information) =
          odometry::ComputeRGBDOdometry(*cur, *prev_, intrinsics_);
      if (tracked) {
        const Eigen::Matrix3d R = prev_from_cur.topLeftCorner<3, 3>();
        world_from_cam_ =
            world_from_cam_ * Rigid3d(Eigen::Quaterniond(R),
                                      prev_from_cur.topRightCorner<3, 1>());
      }
    }
    prev_ = std::move(cur);
    if (!tracked) return std::nullopt;
    return world_from_cam_;
  }

 private:
  open3d::camera::PinholeCameraIntrinsic intrinsics_;
  std::unique_ptr<geometry::RGBDImage> prev_;
  Rigid3d world_from_cam_;
};

}  // namespace

std::unique_ptr<FrameTracker> MakeOpen3dHybrid(const RgbdCamera& camera) {
  return std::make_unique<Open3dHybrid>(camera.camera);
}

}  // namespace rgbd_pose
