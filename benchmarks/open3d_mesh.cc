#include <open3d/pipelines/integration/ScalableTSDFVolume.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "benchmarks/mesh_makers.h"

namespace rgbd_pose {
namespace {

namespace geometry = open3d::geometry;
namespace integration = open3d::pipelines::integration;

class Open3dMesh final : public MeshMaker {
 public:
  explicit Open3dMesh(const MeshFusionOptions& options)
      : options_(options),
        intrinsics_(options.camera.width, options.camera.height,
                    options.camera.fx, options.camera.fy, options.camera.cx,
                    options.camera.cy),
        volume_(options.voxel_size, options.kTruncation * options.voxel_size,
                integration::TSDFVolumeColorType::RGB8) {}

  void Add(const Frame& frame, const Rigid3d& world_from_cam) override {
    geometry::RGBDImage image;
    image.color_.Prepare(frame.color.cols, frame.color.rows, 3, 1);
    cv::Mat rgb(frame.color.size(), CV_8UC3, image.color_.data_.data());
    cv::cvtColor(frame.color, rgb, cv::COLOR_BGR2RGB);
    image.depth_.Prepare(frame.depth.cols, frame.depth.rows, 1, sizeof(float));
    cv::Mat depth(frame.depth.size(), CV_32FC1, image.depth_.data_.data());
    frame.depth.convertTo(depth, CV_32FC1, 1.0 / frame.depth_scale);
    depth.setTo(0.0F, depth > options_.depth.max_depth);
    const Rigid3d cam_from_world = world_from_cam.Inverse();
    Eigen::Matrix4d extrinsic = Eigen::Matrix4d::Identity();
    extrinsic.topLeftCorner<3, 3>() =
        cam_from_world.rotation.toRotationMatrix();
    extrinsic.topRightCorner<3, 1>() = cam_from_world.translation;
    volume_.Integrate(image, intrinsics_, extrinsic);
  }

  TriangleMesh Mesh() override {
    const auto extracted = volume_.ExtractTriangleMesh();
    TriangleMesh mesh;
    mesh.triangles = extracted->triangles_;
    for (size_t i = 0; i < extracted->vertices_.size(); ++i) {
      ColoredPoint point;
      point.position = extracted->vertices_[i].cast<float>();
      mesh.vertices.push_back(point);
    }
    return mesh;
  }

 private:
  MeshFusionOptions options_;
  open3d::camera::PinholeCameraIntrinsic intrinsics_;
  integration::ScalableTSDFVolume volume_;
};

}  // namespace

std::unique_ptr<MeshMaker> MakeOpen3dMesh(const MeshFusionOptions& options) {
  return std::make_unique<Open3dMesh>(options);
}

}  // namespace rgbd_pose
