#include "apps/results/tracking_pictures.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace rgbd_pose {
namespace {

// Bright enough to show whether the image is dimmed.
constexpr int kGray = 200;

Frame GrayFrame(const Camera& camera) {
  Frame frame;
  frame.gray = cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(kGray));
  return frame;
}

// Matches from one ideal pixel to another.
FeatureMatches Matches(const Camera& camera,
                       const std::vector<std::array<double, 4>>& pixels) {
  FeatureMatches found;
  found.matches = Correspondences(camera);
  for (const auto& [u_prev, v_prev, u_cur, v_cur] : pixels) {
    Observation prev;
    Observation cur;
    prev.u = u_prev;
    prev.v = v_prev;
    cur.u = u_cur;
    cur.v = v_cur;
    EXPECT_TRUE(found.matches.Add(prev, cur));
    found.features.push_back(static_cast<int>(found.features.size()));
  }
  return found;
}

MotionEstimate Weighted(const std::vector<double>& weights) {
  MotionEstimate estimate;
  estimate.weights = weights;
  return estimate;
}

using Pixels = std::vector<std::array<double, 4>>;

cv::Mat Draw(const Camera& camera, const Pixels& pixels,
             const MotionEstimate& estimate, const std::string& caption = "") {
  return DrawMatches(GrayFrame(camera), camera, Matches(camera, pixels),
                     estimate, caption);
}

cv::Vec3b At(const cv::Mat& picture, int x, int y) {
  return picture.at<cv::Vec3b>(y, x);
}

// Checked by hue, which holds for any colour map of this kind: yellow for good
// matches, magenta for outliers.
bool IsYellow(const cv::Vec3b& c) {
  return c[0] < 100 && c[1] > 200 && c[2] > 200;
}
bool IsMagenta(const cv::Vec3b& c) {
  return c[0] > 120 && c[1] < 60 && c[2] > 120;
}
bool IsGray(const cv::Vec3b& c) { return c[0] == c[1] && c[1] == c[2]; }

// Whether the pictures differ in the rows first <= y < last.
bool Differ(const cv::Mat& a, const cv::Mat& b, int first, int last) {
  return cv::norm(a.rowRange(first, last), b.rowRange(first, last),
                  cv::NORM_INF) > 0.0;
}

TEST(TrackingPicturesTest, DrawsLinesAndDotsInTheColourOfTheWeight) {
  const Camera camera;
  const cv::Mat picture = Draw(
      camera, {{100, 50, 140, 50}, {300, 400, 300, 350}}, Weighted({1, 0}));
  // Along the line.
  EXPECT_TRUE(IsYellow(At(picture, 102, 50)));
  EXPECT_TRUE(IsYellow(At(picture, 120, 50)));
  EXPECT_TRUE(IsMagenta(At(picture, 300, 398)));
  // The dot is at cur: wider than the line, and only there.
  EXPECT_TRUE(IsYellow(At(picture, 140, 52)));
  EXPECT_TRUE(IsGray(At(picture, 100, 52)));
  EXPECT_TRUE(IsMagenta(At(picture, 302, 350)));
  EXPECT_TRUE(IsGray(At(picture, 302, 400)));
}

TEST(TrackingPicturesTest, DimsTheImageAndLeavesItAlone) {
  const Camera camera;
  const Frame frame = GrayFrame(camera);
  const cv::Mat picture =
      DrawMatches(frame, camera, Matches(camera, {{100, 50, 140, 50}}),
                  Weighted({1}), "a caption");
  EXPECT_TRUE(IsGray(At(picture, 500, 300)));
  EXPECT_LT(At(picture, 500, 300)[0], kGray * 2 / 3);
  EXPECT_GT(At(picture, 500, 300)[0], kGray / 4);
  EXPECT_EQ(frame.gray.at<uchar>(50, 120), kGray) << "drew into the frame";
}

TEST(TrackingPicturesTest, GoodMatchesLieOnTopOfOutliers) {
  const Camera camera;
  const Pixels crossing = {{100, 100, 140, 100}, {120, 80, 120, 120}};
  for (const MotionEstimate& estimate : {Weighted({1, 0}), Weighted({0, 1})}) {
    EXPECT_TRUE(IsYellow(At(Draw(camera, crossing, estimate), 120, 100)));
  }
}

TEST(TrackingPicturesTest, PutsIdealPixelsBackIntoTheDistortedImage) {
  const Camera camera = CameraPreset("tum_fr1")->camera;
  const Eigen::Vector2d prev = camera.Undistort({30, 40});
  const Eigen::Vector2d cur = camera.Undistort({60, 40});
  ASSERT_GT((cur - Eigen::Vector2d(60, 40)).norm(), 6.0)
      << "the distortion is too small to be seen";
  const cv::Mat picture =
      Draw(camera, {{prev.x(), prev.y(), cur.x(), cur.y()}}, Weighted({1}));
  EXPECT_TRUE(IsYellow(At(picture, 60, 40)));
  EXPECT_TRUE(IsYellow(At(picture, 60, 42)));
  EXPECT_TRUE(IsYellow(At(picture, 32, 40)));
  EXPECT_TRUE(IsGray(At(picture, 66, 40)));
}

TEST(TrackingPicturesTest, WithoutWeightsMatchesAreLightGrey) {
  const Camera camera;
  const Pixels two = {{100, 50, 140, 50}, {300, 400, 300, 350}};
  for (const MotionEstimate& estimate :
       {MotionEstimate(), Weighted({1}), Weighted({1, 1, 1})}) {
    const cv::Mat picture = Draw(camera, two, estimate);
    EXPECT_TRUE(IsGray(At(picture, 120, 50)));
    EXPECT_GT(At(picture, 120, 50)[0], At(picture, 120, 60)[0]);
  }
}

TEST(TrackingPicturesTest, TheCaptionAndTheLegendAreBelowTheImage) {
  for (const int width : {320, 640, 1280}) {
    SCOPED_TRACE(width);
    Camera camera;
    camera.width = width;
    camera.height = width * 3 / 4;
    const auto draw = [&camera](const std::string& caption) {
      return Draw(camera, {}, MotionEstimate(), caption);
    };
    const cv::Mat plain = draw("");
    const cv::Mat titled = draw("frame 7  ok  1 of 1 matches  reference 3");
    ASSERT_EQ(plain.type(), CV_8UC3);
    EXPECT_EQ(plain.cols, width);
    EXPECT_GT(plain.rows, camera.height);
    ASSERT_EQ(titled.size(), plain.size());
    ASSERT_EQ(draw(std::string(500, 'W')).size(), plain.size());

    EXPECT_FALSE(Differ(titled, plain, 0, camera.height));
    EXPECT_TRUE(Differ(titled, plain, camera.height, plain.rows));

    // Both ends of the colour scale are in the strip, and not in the image.
    int yellow = 0;
    int magenta = 0;
    for (int y = camera.height; y < plain.rows; ++y) {
      for (int x = 0; x < width; ++x) {
        yellow += IsYellow(At(plain, x, y));
        magenta += IsMagenta(At(plain, x, y));
      }
    }
    EXPECT_GT(yellow, 10);
    EXPECT_GT(magenta, 10);
  }
}

// At 320 px, a caption of usual length is wrapped into two rows instead of
// being cut off: the right margin stays empty, and the caption's end is
// visible.
TEST(TrackingPicturesTest, LongCaptionsAreWrapped) {
  Camera camera;
  camera.width = 320;
  camera.height = 240;
  const auto draw = [&camera](const std::string& caption) {
    return Draw(camera, {}, MotionEstimate(), caption);
  };
  const std::string caption =
      "frame 1234  degraded  312 of 340 matches  reference 111";
  const cv::Mat plain = draw("");
  const cv::Mat titled = draw(caption);
  EXPECT_TRUE(Differ(titled, draw(caption + "8"), camera.height, titled.rows));
  EXPECT_EQ(cv::norm(titled.colRange(316, 320), plain.colRange(316, 320),
                     cv::NORM_INF),
            0.0);
}

TEST(TrackingPicturesTest, TakesAnythingThatIsFinite) {
  Camera camera{8, 6, 10, 10, 4, 3, 0.1, -0.2, 0.01, -0.02, 0.3};
  const cv::Mat picture =
      Draw(camera, {{9e5, -9e5, 9e5, 5}, {-50, -50, 50, 50}, {3, 3, 3, 3}},
           Weighted({-1, 0.5, 7}), "a caption");
  EXPECT_EQ(picture.cols, 8);
  EXPECT_TRUE(IsYellow(At(picture, 3, 3)));
}

}  // namespace
}  // namespace rgbd_pose
