#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>

#include "frontend/features/patch.h"

namespace rgbd_pose {
namespace {

constexpr int kSide = 64;
const Eigen::Vector2d kCentre(31.0, 33.0);

// Bilinear interpolation of the texture below, with wavelengths of 9 px and
// more, has an error of 2 % of the contrast. Grey levels are rounded to 1 of
// about 60. Over 64 pixels, this leaves a few hundredths of a pixel.
constexpr double kExactPx = 0.05;

constexpr float kMinStepPx = 0.02F;  // as on the finest level

// A texture with gradients in all directions.
double Texture(const Eigen::Vector2d& x) {
  return 120.0 + 25.0 * std::sin(0.45 * x.x() + 0.2 * x.y()) +
         25.0 * std::sin(0.15 * x.x() - 0.52 * x.y() + 1.0) +
         15.0 * std::sin(0.6 * x.x() + 0.35 * x.y() + 2.0);
}

cv::Mat Render(const std::function<double(const Eigen::Vector2d&)>& grey) {
  cv::Mat image(kSide, kSide, CV_8UC1);
  for (int v = 0; v < kSide; ++v) {
    for (int u = 0; u < kSide; ++u) {
      image.at<uint8_t>(v, u) =
          cv::saturate_cast<uint8_t>(grey(Eigen::Vector2d(u, v)));
    }
  }
  return image;
}

Patch PatchOf(const cv::Mat& image,
              const Eigen::Matrix2f& warp = Eigen::Matrix2f::Identity()) {
  Patch patch;
  MakePatch(image, kCentre.cast<float>(), warp, &patch);
  return patch;
}

AlignedPatch Align(const Patch& patch, const cv::Mat& image,
                   const Eigen::Vector2d& start = kCentre) {
  return AlignPatch(patch, image, static_cast<float>(start.x()),
                    static_cast<float>(start.y()), kMinStepPx);
}

// Expects that the patch is found at `expected`.
void ExpectAt(const AlignedPatch& found, const Eigen::Vector2d& expected) {
  ASSERT_TRUE(found.found);
  EXPECT_NEAR(found.u, expected.x(), kExactPx);
  EXPECT_NEAR(found.v, expected.y(), kExactPx);
  EXPECT_GT(found.correlation, 0.99F);
}

TEST(PatchAlignmentTest, FindsSubPixelShifts) {
  const Patch patch = PatchOf(Render(Texture));
  for (const Eigen::Vector2d& shift :
       {Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.3, -0.4),
        Eigen::Vector2d(-1.25, 0.5), Eigen::Vector2d(1.6, 1.3)}) {
    const cv::Mat moved =
        Render([&](const Eigen::Vector2d& x) { return Texture(x - shift); });
    SCOPED_TRACE(shift.transpose());
    ExpectAt(Align(patch, moved), kCentre + shift);
  }
}

TEST(PatchAlignmentTest, TheSameImageIsFoundWhereItWas) {
  const cv::Mat image = Render(Texture);
  const AlignedPatch found = Align(PatchOf(image), image);
  ASSERT_TRUE(found.found);
  // Rounding of sums of 64 floats.
  EXPECT_NEAR(found.u, kCentre.x(), 1e-4);
  EXPECT_NEAR(found.v, kCentre.y(), 1e-4);
  EXPECT_NEAR(found.residual, 0.0F, 0.1);
}

TEST(PatchAlignmentTest, GainAndBiasDoNotMatter) {
  const Patch patch = PatchOf(Render(Texture));
  const Eigen::Vector2d shift(0.7, -0.45);
  for (const double gain : {0.5, 0.8, 1.4, 2.0}) {
    for (const double bias : {-20.0, 0.0, 15.0}) {
      const cv::Mat image = Render([&](const Eigen::Vector2d& x) {
        // Scaled about the middle, which avoids saturation.
        return 125.0 + gain * 0.8 * (Texture(x - shift) - 120.0) + bias;
      });
      SCOPED_TRACE(testing::Message() << gain << " " << bias);
      ExpectAt(Align(patch, image), kCentre + shift);
    }
  }
}

TEST(PatchAlignmentTest, FollowsAnAffineWarp) {
  const cv::Mat ref = Render(Texture);
  Eigen::Matrix2d ref_from_cur;
  ref_from_cur = Eigen::Rotation2Dd(0.3).toRotationMatrix() *
                 Eigen::DiagonalMatrix<double, 2>(1.25, 0.85);
  const Eigen::Vector2d shift(-0.6, 0.35);
  const cv::Mat cur = Render([&](const Eigen::Vector2d& x) {
    return Texture(kCentre + ref_from_cur * (x - kCentre - shift));
  });
  ExpectAt(Align(PatchOf(ref, ref_from_cur.cast<float>()), cur),
           kCentre + shift);
  // Without the warp it fails, which shows that the test above is meaningful.
  const AlignedPatch plain = Align(PatchOf(ref), cur);
  EXPECT_TRUE(!plain.found || plain.correlation < 0.97F);
}

TEST(PatchAlignmentTest, TellsAnotherPlace) {
  const Patch patch = PatchOf(Render(Texture));
  const cv::Mat other = Render([](const Eigen::Vector2d& x) {
    return Texture(2.3 * Eigen::Vector2d(-x.y(), x.x()));
  });
  const AlignedPatch found = Align(patch, other);
  EXPECT_TRUE(!found.found || found.correlation < 0.8F);
  // The negative of the image must not match either.
  const cv::Mat negative =
      Render([](const Eigen::Vector2d& x) { return 240.0 - Texture(x); });
  const AlignedPatch inverted = Align(patch, negative);
  EXPECT_TRUE(!inverted.found || inverted.correlation < 0.8F);
}

TEST(PatchAlignmentTest, FlatPlacesAndStraightEdgesHoldNothing) {
  const cv::Mat texture = Render(Texture);
  const cv::Mat flat(kSide, kSide, CV_8UC1, cv::Scalar(80));
  EXPECT_EQ(PatchOf(flat).min_eigenvalue, 0.0F);
  EXPECT_FALSE(Align(PatchOf(flat), texture).found);
  EXPECT_FALSE(Align(PatchOf(texture), flat).found);
  const cv::Mat edge = Render([](const Eigen::Vector2d& x) {
    return 100.0 + 60.0 * std::tanh(0.5 * (x.x() - kCentre.x()));
  });
  EXPECT_EQ(PatchOf(edge).min_eigenvalue, 0.0F);
}

TEST(PatchAlignmentTest, NeverLeavesTheImage) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const cv::Mat image = Render(Texture);
  const Patch patch = PatchOf(image);
  for (const double edge : {-1e9, -5.0, 0.0, 3.9, 60.1, 64.0, 1e9, kNan}) {
    EXPECT_FALSE(Align(patch, image, {edge, 30.0}).found) << edge;
    EXPECT_FALSE(Align(patch, image, {30.0, edge}).found) << edge;
  }
  // A patch may be at the border; border pixels are repeated.
  Patch corner;
  MakePatch(image, {0.0F, 63.0F}, Eigen::Matrix2f::Identity(), &corner);
  Align(corner, image);
  // Patches can be aligned up to the last pixel.
  Patch last;
  MakePatch(image, {59.0F, 59.0F}, Eigen::Matrix2f::Identity(), &last);
  const AlignedPatch found = Align(last, image, {59.4, 59.4});
  EXPECT_TRUE(found.found);
  EXPECT_NEAR(found.u, 59.0F, kExactPx);
}

TEST(PatchAlignmentTest, NoiseMovesItAsMuchAsThePatchSays) {
  const Patch patch = PatchOf(Render(Texture));
  constexpr int kTrials = 200;
  constexpr double kNoise = 8.0;  // grey levels, half range of uniform noise
  uint32_t state = 1;
  double squares = 0.0;
  for (int i = 0; i < kTrials; ++i) {
    const cv::Mat noisy = Render([&](const Eigen::Vector2d& x) {
      state = 1664525u * state + 1013904223u;
      return Texture(x) + kNoise * ((state >> 8) / 8388608.0 - 1.0);
    });
    const AlignedPatch found = Align(patch, noisy);
    ASSERT_TRUE(found.found);
    squares +=
        std::pow(found.u - kCentre.x(), 2) + std::pow(found.v - kCentre.y(), 2);
  }
  const double rms = std::sqrt(squares / kTrials);
  // The rms is at least the worst direction's and at most sqrt(2) times that.
  const double worst = kNoise / std::sqrt(3.0 * patch.min_eigenvalue);
  EXPECT_LT(rms, 1.1 * std::sqrt(2.0) * worst);
  EXPECT_GT(rms, 0.5 * worst);
}

// The warp is the derivative of the projection of the plane's points.
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
    // Without a normal, the plane is parallel to the image.
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
    // The result has single precision.
    EXPECT_LT((PlaneWarp(camera, ref, motion).cast<double>() - expected)
                  .lpNorm<Eigen::Infinity>(),
              1e-6);
    EXPECT_GT((expected - Eigen::Matrix2d::Identity()).norm(), 0.1);
  }
}

}  // namespace
}  // namespace rgbd_pose
