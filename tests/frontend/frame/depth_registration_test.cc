#include "frontend/frame/depth_registration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "frontend/frame/frame.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/motions.h"

namespace rgbd_pose {
namespace {

constexpr double kUnits = 5000.0;

Camera CameraOfSize(int width, int height, double focal) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  return camera;
}

TEST(DepthRegistrationTest, OfTheSameCameraChangesNothing) {
  const Camera camera = CameraOfSize(64, 48, 50.0);
  cv::Mat depth(48, 64, CV_16UC1);
  for (int i = 0; i < 64 * 48; ++i) {
    depth.at<uint16_t>(i / 64, i % 64) = static_cast<uint16_t>(1000 + 7 * i);
  }
  depth.at<uint16_t>(5, 6) = 0;
  depth.at<uint16_t>(7, 8) = Frame::kNoDepth;
  const cv::Mat registered =
      DepthRegistration({camera, {}}, camera).Register(depth, kUnits);
  depth.at<uint16_t>(7, 8) = 0;
  EXPECT_EQ(cv::norm(depth, registered, cv::NORM_INF), 0.0);
}

// A depth camera with another lens, size and position views the simulated room.
// The result is compared with depth rendered for the colour camera.
struct TwoLenses {
  const char* name;
  LensModel color_model, depth_model;
  std::vector<double> color, depth;
};

class RegistrationOfLensesTest : public testing::TestWithParam<TwoLenses> {};

TEST_P(RegistrationOfLensesTest, IsWhatTheColourCameraWouldHaveSeen) {
  SyntheticOptions options;
  options.frames = 3;
  options.noise = false;
  options.camera.camera = CameraOfSize(320, 240, 260.0);
  ASSERT_TRUE(options.camera.camera.SetDistortion(GetParam().color_model,
                                                  GetParam().color));
  const SyntheticDataset color(options);
  Camera depth_camera = CameraOfSize(400, 300, 290.0);
  ASSERT_TRUE(
      depth_camera.SetDistortion(GetParam().depth_model, GetParam().depth));
  const Rigid3d color_from_depth =
      Moved(0.025, -0.003, 0.004) *
      Turned(0.02, Eigen::Vector3d(1.0, -2.0, 0.5).normalized());
  SyntheticOptions raw = options;
  raw.depth_camera = DepthCamera{depth_camera, color_from_depth};
  const SyntheticDataset depth(raw);
  const DepthRegistration registration(*raw.depth_camera,
                                       options.camera.camera);
  for (int k = 0; k < 3; ++k) {
    const Frame truth = color.Read(k);
    const cv::Mat registered =
        registration.Register(depth.Read(k).depth, truth.depth_scale);
    int both = 0;
    int close = 0;
    int behind = 0;  // points that should be hidden
    int pinholes = 0;
    for (int row = 0; row < truth.depth.rows; ++row) {
      for (int column = 0; column < truth.depth.cols; ++column) {
        const double seen = truth.DepthAt(column, row);
        const double got =
            registered.at<uint16_t>(row, column) / truth.depth_scale;
        const auto is_hole = [&](int v, int u) {
          return registered.at<uint16_t>(v, u) == 0;
        };
        if (got == 0.0 && row > 0 && column > 0 && row + 1 < registered.rows &&
            column + 1 < registered.cols) {
          pinholes += !is_hole(row, column - 1) && !is_hole(row, column + 1) &&
                      !is_hole(row - 1, column) && !is_hole(row + 1, column);
        }
        if (seen == 0.0 || got == 0.0) continue;
        ++both;
        close += std::abs(got - seen) < 0.01 * seen;
        behind += got > 1.1 * seen;
      }
    }
    // All pixels except those that the depth camera does not see.
    EXPECT_GT(both, 0.98 * truth.depth.total());
    EXPECT_LT(pinholes, 0.001 * both);
    // Depth is correct except at edges.
    EXPECT_GT(close, 0.97 * both);
    EXPECT_LT(behind, 0.004 * both);
  }
}

INSTANTIATE_TEST_SUITE_P(
    DepthRegistration, RegistrationOfLensesTest,
    testing::Values(TwoLenses{"PlumbBobs",
                              LensModel::kRational,
                              LensModel::kRational,
                              {0.1, -0.2, 0.002, 0.0},
                              {-0.05, 0.0, 0.0, 0.0}},
                    // Similar to an Azure Kinect's.
                    TwoLenses{
                        "Rationals",
                        LensModel::kRational,
                        LensModel::kRational,
                        {0.47, -2.5, 9e-4, -3e-4, 1.48, 0.35, -2.33, 1.41},
                        {0.3, 0.1, 0.0, 1e-4, 0.005, 0.64, 0.16, 0.01}},
                    TwoLenses{"Fisheyes",
                              LensModel::kEquidistant,
                              LensModel::kEquidistant,
                              {-0.02, 0.004, 0.0, 0.0},
                              {-0.008, 0.045, -0.042, 0.008}}),
    [](const auto& info) { return info.param.name; });

TEST(DepthRegistrationTest, WhatIsNearHidesWhatIsBehind) {
  const Camera camera = CameraOfSize(64, 48, 50.0);
  // A near half that covers a part of the far half when seen from the side.
  cv::Mat depth(48, 64, CV_16UC1, cv::Scalar(4.0 * kUnits));
  depth.colRange(0, 32).setTo(1.0 * kUnits);
  const Rigid3d color_from_depth = Moved(0.2, 0.0, 0.0);
  const cv::Mat registered =
      DepthRegistration({camera, color_from_depth}, camera)
          .Register(depth, kUnits);
  // 0.2 m are 10 px at 1 m and 2.5 px at 4 m.
  for (int row = 0; row < 48; ++row) {
    EXPECT_EQ(registered.at<uint16_t>(row, 5), 0) << "nobody saw that";
    for (int column = 10; column < 42; ++column) {
      ASSERT_EQ(registered.at<uint16_t>(row, column), 1.0 * kUnits) << column;
    }
    ASSERT_EQ(registered.at<uint16_t>(row, 42), 4.0 * kUnits);
  }
}

TEST(DepthRegistrationTest, KeepsHolesAndFillsNone) {
  const Camera depth_camera = CameraOfSize(32, 24, 25.0);
  const Camera color_camera = CameraOfSize(128, 96, 100.0);
  cv::Mat depth(24, 32, CV_16UC1, cv::Scalar(2.0 * kUnits));
  depth(cv::Rect(10, 10, 3, 3)).setTo(0);
  const cv::Mat registered = DepthRegistration({depth_camera, {}}, color_camera)
                                 .Register(depth, kUnits);
  // Four times the size: sixteen pixels for each.
  EXPECT_EQ(cv::countNonZero(registered), 16 * (32 * 24 - 9));
  EXPECT_EQ(cv::countNonZero(registered(cv::Rect(40, 40, 12, 12))), 0);
}

TEST(DepthRegistrationTest, LeavesOutWhatIsBehindTheCamera) {
  const Camera camera = CameraOfSize(64, 48, 50.0);
  const cv::Mat depth(48, 64, CV_16UC1, cv::Scalar(1.0 * kUnits));
  const Rigid3d color_from_depth = Moved(0.0, 0.0, -2.0);
  EXPECT_EQ(
      cv::countNonZero(DepthRegistration({camera, color_from_depth}, camera)
                           .Register(depth, kUnits)),
      0);
}

TEST(DepthRegistrationTest, RefusesBadCameras) {
  const Camera good = CameraOfSize(64, 48, 50.0);
  Camera bad = good;
  bad.fx = 0.0;
  ExpectInputError(
      [&] {
        DepthRegistration({bad, {}}, good);
      },
      {"depth camera", "fx"});
  ExpectInputError(
      [&] {
        DepthRegistration({good, {}}, bad);
      },
      {"colour camera", "fx"});
}

}  // namespace
}  // namespace rgbd_pose
