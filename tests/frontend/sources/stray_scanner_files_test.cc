#include "frontend/sources/stray_scanner_files.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

const cv::Size kVideo(1280, 960);
const std::string kColumns = "timestamp, frame, x, y, z, qx, qy, qz, qw\n";
const std::string kRow = "100.0, 000007, 1, 2, 3, 0, 0, 0.6, 0.8\n";

TEST(StrayScannerFilesTest, AreRead) {
  TempFolder folder;
  folder.Write("odometry.csv", kColumns + kRow +
                                   "100.5, 8, 1, 2, 3, 0, 0, 0, 1, 900, 901, "
                                   "640, 480, , \n");
  folder.Write("depth/7.png", "");
  folder.Write("confidence/000007.png", "");
  const std::vector<StrayRow> rows = ReadStrayRows(folder.path(), kVideo);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].timestamp, 100.0);
  EXPECT_EQ(rows[0].image, 0);
  EXPECT_EQ(rows[0].world_from_cam.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(rows[0].world_from_cam.rotation.z(), 0.6, 1e-12);
  EXPECT_EQ(rows[0].depth_path, folder / "depth/7.png");
  EXPECT_EQ(rows[0].confidence_path, folder / "confidence/000007.png");
  EXPECT_FALSE(rows[0].camera.has_value());
  EXPECT_EQ(rows[1].image, 1);
  EXPECT_EQ(rows[1].depth_path, "");
  ASSERT_TRUE(rows[1].camera.has_value());
  EXPECT_EQ(rows[1].camera->fy, 901.0);

  folder.Write("camera_matrix.csv", "1600, 0, 640\n0, 1601, 480\n0, 0, 1");
  const Camera camera = ReadStrayCamera(folder.path(), kVideo);
  EXPECT_EQ(camera.width, 1280);
  EXPECT_EQ(camera.fy, 1601.0);
  EXPECT_EQ(camera.cx, 640.0);
}

TEST(StrayScannerFilesTest, DamagedOdometryIsRefused) {
  TempFolder folder;
  const struct {
    std::string text;
    std::vector<std::string> said;
  } cases[] = {
      {"", {"odometry.csv: needs the columns timestamp"}},
      {kRow, {"needs the columns timestamp, frame"}},
      {kColumns + "100.0, 000", {"odometry.csv:2: needs 9 columns, has 2"}},
      {kColumns + kRow + kRow, {"odometry.csv:3: the time stamp is not after"}},
      {kColumns + "100.0, 0, 0, x, 0, 0, 0, 0, 1\n",
       {"odometry.csv:2: ", "'x'"}},
      {kColumns + "100.0, 0, 0, 0, 0, 0, 0, 0, 0\n",
       {"odometry.csv:2: the quaternion"}},
      {kColumns + "100, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1",
       {"odometry.csv:2: fx and fy must be in pixels"}},
  };
  for (const auto& c : cases) {
    folder.Write("odometry.csv", c.text);
    ExpectInputError([&] { ReadStrayRows(folder.path(), kVideo); }, c.said);
  }
}

TEST(StrayScannerFilesTest, WhatIsNoCameraMatrixIsRefused) {
  TempFolder folder;
  const struct {
    const char* text;
    std::vector<std::string> said;
  } cases[] = {
      {"1600, 0, 960\n0, 1600, 720\n", {"csv: is not a camera matrix"}},
      {"1600, 0, 0\n0, 1600, 0\n960, 720, 1", {"csv: is not a camera matrix"}},
      {"-900, 0, 640\n0, 900, 480\n0, 0, 1",
       {"camera_matrix.csv: fx and fy must be positive"}},
  };
  for (const auto& c : cases) {
    folder.Write("camera_matrix.csv", c.text);
    ExpectInputError([&] { ReadStrayCamera(folder.path(), kVideo); }, c.said);
  }
}

}  // namespace
}  // namespace rgbd_pose
