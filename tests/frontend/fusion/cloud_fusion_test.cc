#include "frontend/fusion/cloud_fusion.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "frontend/simulation/synthetic_dataset.h"

namespace rgbd_pose {
namespace {

FusionOptions Options(const Camera& camera) {
  FusionOptions options;
  options.camera = camera;
  return options;
}

// A wall 2 m ahead, with a plate at 1 m in front of its left part.
Frame WallAndPlate(const Camera& camera, int between_px) {
  Frame frame;
  frame.depth.create(camera.height, camera.width, CV_16UC1);
  frame.depth.setTo(10000);
  frame.depth.colRange(0, 200).setTo(5000);
  // Sensors measure depths in between at the edge.
  frame.depth.colRange(200, 200 + between_px).setTo(7500);
  frame.color.create(frame.depth.size(), CV_8UC3);
  frame.color.setTo(cv::Scalar(10, 20, 30));
  return frame;
}

TEST(CloudFusionTest, LeavesOutPointsBetweenTwoSurfaces) {
  const Camera camera;
  CloudFusion fusion(Options(camera));
  fusion.Add(WallAndPlate(camera, 1), Rigid3d());
  ASSERT_GT(fusion.cloud().size(), 10000);
  for (const ColoredPoint& point : fusion.cloud().Points()) {
    const float z = point.position.z();
    EXPECT_LT(std::min(std::abs(z - 1.0F), std::abs(z - 2.0F)), 1e-5F);
    EXPECT_THAT(point.color, testing::ElementsAre(30, 20, 10));
  }
}

TEST(CloudFusionTest, LeavesOutWhatIsTooNearTooFarOrMissing) {
  const Camera camera;
  // 0.3 m and 8 m are 1500 and 40000 units.
  for (const int raw : {0, 1499, 40001, 65535}) {
    CloudFusion fusion(Options(camera));
    Frame frame;
    frame.depth.create(camera.height, camera.width, CV_16UC1);
    frame.depth.setTo(raw);
    frame.color = cv::Mat::zeros(frame.depth.size(), CV_8UC3);
    fusion.Add(frame, Rigid3d());
    EXPECT_EQ(fusion.cloud().size(), 0) << raw;
  }
}

// Seen through a distorting lens, the walls of a room are at the right place.
TEST(CloudFusionTest, PutsDistortedViewsTogetherToTheRoom) {
  SyntheticOptions options;
  options.path = "pan_tilt";
  options.frames = 4;
  options.noise = false;
  options.camera = *CameraPreset("tum_fr1");
  const SyntheticDataset dataset(options);
  CloudFusion fusion(Options(dataset.camera().camera));
  for (int i = 0; i < dataset.size(); ++i) {
    fusion.Add(dataset.Read(i), dataset.WorldFromCam(i));
  }
  // The room is 5 x 4 x 2.6 m around the world's z axis.
  constexpr float kTolerance = 0.005F;  // a depth step, 0.2 mm, and slant
  float deepest = 0.0F;
  for (const ColoredPoint& point : fusion.cloud().Points()) {
    deepest = std::max({deepest, std::abs(point.position.x()) - 2.5F,
                        std::abs(point.position.y()) - 2.0F});
  }
  EXPECT_LT(deepest, kTolerance);
  EXPECT_GT(deepest, -kTolerance);  // a wall is in view
}

TEST(MotionFilterTest, IsReachedByAShiftOrATurn) {
  const MotionFilter filter;
  Rigid3d moved;
  EXPECT_FALSE(filter.IsReached(moved));
  moved.translation.x() = 0.049;
  EXPECT_FALSE(filter.IsReached(moved));
  moved.translation.x() = 0.051;
  EXPECT_TRUE(filter.IsReached(moved));
  EXPECT_TRUE(filter.IsReached(Rigid3d::FromRotationVector(
      {0, 3.1 * M_PI / 180.0, 0}, Eigen::Vector3d::Zero())));
}

// Rows of pixels alternate between 1 m and 1.03 m: this is noise for one model,
// but not for the other.
TEST(CloudFusionTest, NoiseIsWhatTheDepthNoiseModelSays) {
  const Camera camera;
  Frame frame = WallAndPlate(camera, 0);
  frame.depth.setTo(5000);
  for (int y = 0; y < frame.depth.rows; y += 2) frame.depth.row(y).setTo(5150);
  for (const bool constant : {false, true}) {
    FusionOptions options = Options(camera);
    options.depth.noise =
        *FindNamed(DepthNoiseModels(), constant ? "constant" : "khoshelham");
    CloudFusion fusion(options);
    fusion.Add(frame, Rigid3d());
    EXPECT_EQ(fusion.cloud().size() > 0, constant);
  }
}

TEST(CloudFusionTest, ChecksItsOptions) {
  for (const double bad : {0.0, -0.01, 0.0009, 1.1, std::nan("")}) {
    FusionOptions options;
    options.voxel_size = bad;
    EXPECT_NE(options.Check(), "") << bad;
  }
  EXPECT_EQ(FusionOptions().Check(), "");
}

}  // namespace
}  // namespace rgbd_pose
