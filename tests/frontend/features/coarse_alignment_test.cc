#include "frontend/features/coarse_alignment.h"

#include <ceres/jet.h>
#include <ceres/rotation.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "frontend/features/plane_warp.h"
#include "frontend/image/image_pyramid.h"
#include "frontend/simulation/synthetic_dataset.h"

namespace rgbd_pose {
namespace {

constexpr int kLevels = 6;

// A fifth of a pixel of the finest level, 80 x 60, as of the full image.
constexpr double kGoodPx = 1.6;

class CoarseAlignmentTest : public ::testing::Test {
 protected:
  CoarseAlignmentTest()
      : dataset_(SyntheticOptions()),
        camera_(dataset_.camera().camera),
        ref_(dataset_.Read(0)),
        cur_(dataset_.Read(15)),
        cur_from_ref_(dataset_.WorldFromCam(15).Inverse() *
                      dataset_.WorldFromCam(0)) {}

  static std::vector<cv::Mat> PyramidOf(const cv::Mat& gray) {
    std::vector<cv::Mat> pyramid;
    BuildImagePyramid(gray, kLevels, &pyramid);
    return pyramid;
  }

  Rigid3d Align(const cv::Mat& cur, const Rigid3d& guess) const {
    return CoarseReference(ref_, PyramidOf(ref_.gray), camera_)
        .Align(PyramidOf(cur), guess);
  }

  // How far (px, RMS over a grid) points are from where the truth has them.
  double ErrorPx(const Rigid3d& motion) const {
    double squares = 0.0;
    int count = 0;
    for (int v = 40; v < ref_.depth.rows - 40; v += 40) {
      for (int u = 40; u < ref_.depth.cols - 40; u += 40) {
        const double depth = ref_.DepthAt(u, v);
        if (depth <= 0.0) continue;
        const Eigen::Vector3d point =
            camera_.Unproject(Eigen::Vector2d(u, v), depth);
        squares += (camera_.Project(motion * point) -
                    camera_.Project(cur_from_ref_ * point))
                       .squaredNorm();
        ++count;
      }
    }
    return std::sqrt(squares / count);
  }

  Rigid3d OffBy(double px, const Eigen::Vector3d& axis) const {
    return Rigid3d(Eigen::Quaterniond(Eigen::AngleAxisd(px / camera_.fx, axis)),
                   Eigen::Vector3d::Zero()) *
           cur_from_ref_;
  }

  SyntheticDataset dataset_;
  Camera camera_;
  Frame ref_, cur_;
  Rigid3d cur_from_ref_;
};

TEST_F(CoarseAlignmentTest, FindsTheMotionFromFarAway) {
  ASSERT_GT(ErrorPx(Rigid3d()), 10.0) << "the motion is vacuous";
  EXPECT_LT(ErrorPx(Align(cur_.gray, Rigid3d())), kGoodPx);
  for (const double px : {-40.0, 40.0}) {
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(i);
      const Rigid3d guess = OffBy(px, axis);
      SCOPED_TRACE(testing::Message() << px << " " << axis.transpose());
      EXPECT_LT(ErrorPx(Align(cur_.gray, guess)), kGoodPx);
    }
  }
}

TEST_F(CoarseAlignmentTest, ExposureDoesNotMatter) {
  for (const double gain : {0.5, 1.5}) {
    cv::Mat gray;
    cur_.gray.convertTo(gray, CV_8UC1, gain, -10.0);
    EXPECT_LT(ErrorPx(Align(gray, Rigid3d())), kGoodPx) << gain;
  }
}

TEST_F(CoarseAlignmentTest, WithoutAnImageTheGuessStays) {
  const Rigid3d guess = OffBy(7.0, Eigen::Vector3d::UnitY());
  const cv::Mat flat(cur_.gray.size(), CV_8UC1, cv::Scalar(50));
  EXPECT_EQ(Align(flat, guess).translation, guess.translation);
  EXPECT_EQ(Align(flat, guess).rotation.coeffs(), guess.rotation.coeffs());
  const CoarseReference none(ref_, PyramidOf(flat), camera_);
  EXPECT_EQ(none.Align(PyramidOf(cur_.gray), guess).translation,
            guess.translation);
}

// The warp is the derivative of where the points of the plane are seen.
TEST(PlaneWarpTest, IsTheDerivativeOfTheMapOfThePlane) {
  const Camera camera;
  const Rigid3d motion(Eigen::Quaterniond(Eigen::AngleAxisd(
                           0.2, Eigen::Vector3d(0.5, -0.3, 0.8).normalized())),
                       Eigen::Vector3d(0.2, -0.1, 0.3));
  Observation ref;
  ref.u = 400.0;
  ref.v = 150.0;
  ref.depth = 2.0;
  for (const Eigen::Vector3d& normal :
       {Eigen::Vector3d(0.4, -0.3, -0.8), Eigen::Vector3d(0.0, 0.0, -1.0),
        Eigen::Vector3d(0.0, 0.0, 0.0)}) {
    ref.normal = normal.normalized();
    // Without a normal the plane is parallel to the image.
    const Eigen::Vector3d n =
        normal.isZero() ? -Eigen::Vector3d::UnitZ() : ref.normal;
    const Eigen::Vector3d centre =
        camera.Unproject(Eigen::Vector2d(ref.u, ref.v), ref.depth);
    const auto map = [&](double du, double dv) {
      const Eigen::Vector3d ray =
          camera.Unproject(Eigen::Vector2d(ref.u + du, ref.v + dv), 1.0);
      return camera.Project(motion * (n.dot(centre) / n.dot(ray) * ray));
    };
    constexpr double h = 1e-3;
    Eigen::Matrix2d expected;
    expected.col(0) = (map(h, 0.0) - map(-h, 0.0)) / (2.0 * h);
    expected.col(1) = (map(0.0, h) - map(0.0, -h)) / (2.0 * h);
    // The result is of single precision.
    EXPECT_LT((PlaneWarp(camera, ref, motion).cast<double>() - expected)
                  .lpNorm<Eigen::Infinity>(),
              1e-6);
    EXPECT_GT((expected - Eigen::Matrix2d::Identity()).norm(), 0.1);
  }
}

// Of an image with an even gradient, by ceres::Jet.
TEST(PhotometricJacobianTest, EqualsAutodiff) {
  using Jet = ceres::Jet<double, 8>;
  const Camera camera = {640, 480, 520, 530, 320, 240, 0, 0, 0};
  const Eigen::Vector2d gradient(3.0, -2.0);
  constexpr double kGrey = 120.0;
  for (const Eigen::Vector3d& place :
       {Eigen::Vector3d(0.4, -0.3, 1.5), Eigen::Vector3d(-1.0, 0.7, 4.0)}) {
    Jet x[8];
    for (int i = 0; i < 8; ++i) x[i] = Jet(i == 6 ? 1.0 : 0.0, i);
    Eigen::Matrix<Jet, 3, 1> moved;
    ceres::AngleAxisRotatePoint(x, place.cast<Jet>().eval().data(),
                                moved.data());
    for (int i = 0; i < 3; ++i) moved[i] += x[3 + i];
    const Jet du = camera.fx * (moved[0] / moved[2] - place.x() / place.z());
    const Jet dv = camera.fy * (moved[1] / moved[2] - place.y() / place.z());
    const Jet predicted =
        x[6] * (kGrey + gradient.x() * du + gradient.y() * dv) + x[7];
    const Eigen::Matrix<double, 8, 1> row =
        PhotometricJacobian(place.cast<float>(), kGrey, gradient.cast<float>(),
                            camera)
            .cast<double>();
    EXPECT_LE((row - predicted.v).norm(), 1e-6 * predicted.v.norm());
  }
}

}  // namespace
}  // namespace rgbd_pose
