// The whole chain in memory, from images to poses.

#include "frontend/tracking/odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/evaluation/consistency.h"
#include "core/util/input_error.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/motion_error.h"
#include "tests/support/track_sequence.h"

namespace rgbd_pose {
namespace {

TEST(OdometryOptionsTest, NoFieldMayBeNan) {
  for (double OdometryOptions::*field :
       {&OdometryOptions::min_reference_share, &OdometryOptions::max_flow_px,
        &OdometryOptions::new_segment_after,
        &OdometryOptions::max_time_shift}) {
    OdometryOptions options;
    options.*field = std::nan("");
    EXPECT_THROW(MakeOdometry(Camera(), "tukey", options), InputError);
  }
}

TEST(OdometryTest, ComesBackFromPanAndTilt) {
  const SyntheticDataset dataset = Room("pan_tilt", 60);
  for (const std::string loss : {"huber", "tukey"}) {
    const TrackedSequence run = TrackAll(dataset, loss);
    EXPECT_EQ(run.Count(TrackingStatus::kLost), 0) << loss;
    const Rigid3d end = run.trajectory.back().world_from_cam;
    EXPECT_LE(end.Angle(), 0.3 * M_PI / 180.0) << loss;
    EXPECT_LE(end.translation.norm(), 0.005) << loss;
  }
}

TEST(OdometryTest, RefusesImagesOfAnotherSize) {
  const SyntheticDataset dataset((SyntheticOptions()));
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  Frame frame = dataset.Read(0);
  frame.depth = frame.depth.rowRange(0, 240);
  ExpectInputError([&] { odometry.Track(frame); },
                   {"the size of the camera, 640 x 480"});
  Keyframe keyframe;
  keyframe.id = -2;
  keyframe.frame = PreparedFrame(frame);
  ExpectInputError([&] { odometry.InsertKeyframe(keyframe); },
                   {"the size of the camera, 640 x 480"});
}

// While tracking is lost, the pose follows guesses.
TEST(OdometryTest, RefusesGuessesThatAreNotFinite) {
  const SyntheticDataset dataset((SyntheticOptions()));
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  const Frame frame = dataset.Read(0);
  odometry.Track(frame);
  Rigid3d guess;
  MotionMatrix covariance = MotionMatrix::Identity();
  covariance(2, 3) = std::nan("");
  ExpectInputError([&] { odometry.Track(frame, &guess, &covariance); },
                   {"guess or its covariance is not finite"});
  guess.translation.x() = std::nan("");
  ExpectInputError([&] { odometry.Track(frame, &guess); },
                   {"guess or its covariance is not finite"});
  EXPECT_EQ(odometry.Track(frame).index, 1) << "counted a refused frame";
}

TEST(OdometryTest, EveryFrameGetsAResultAndBlackOnesAreLost) {
  const SyntheticDataset dataset = Room("still", 9);
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  int index = 0;
  const auto good = [&] { return dataset.Read(index++); };
  const auto black = [&] { return Black(good()); };
  Frame blind = good();
  blind.depth = cv::Mat(blind.depth.size(), CV_16UC1, cv::Scalar(0));

  // Also at the start, until there are features.
  EXPECT_EQ(odometry.Track(black()).status, TrackingStatus::kLost);
  EXPECT_EQ(odometry.Track(black()).status, TrackingStatus::kLost);
  EXPECT_EQ(odometry.Track(good()).status, TrackingStatus::kOk);
  EXPECT_EQ(odometry.Track(good()).status, TrackingStatus::kOk);
  for (const Frame& bad : {black(), blind, black()}) {
    const TrackedFrame result = odometry.Track(bad);
    EXPECT_EQ(result.status, TrackingStatus::kLost);
    EXPECT_NE(result.reason, "");
    EXPECT_LE(result.world_from_cam.translation.norm(), 0.001) << "not held";
  }
  odometry.Track(good());  // the new reference
  EXPECT_EQ(odometry.Track(good()).status, TrackingStatus::kOk);
}

// An image of the first frames that is sent again starts no path.
TEST(OdometryTest, AStartWithARepeatedImageIsLostWithItsReason) {
  const SyntheticDataset dataset = Room("still", 2);
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  odometry.Track(Black(dataset.Read(0)));
  const TrackedFrame repeated = odometry.Track(dataset.Read(0));
  EXPECT_EQ(repeated.status, TrackingStatus::kLost);
  EXPECT_EQ(repeated.reason, "an image of it is that of the frame before");
  EXPECT_EQ(odometry.Track(dataset.Read(1)).status, TrackingStatus::kOk);
}

// The camera has turned by 29 degrees, more than pixels alone can bridge.
// Without descriptors it would have to be found again among the keyframes.
TEST(OdometryTest, DescriptorsBridgeALargeTurn) {
  SyntheticOptions options;
  options.path = "still";
  const SyntheticDataset dataset(options);
  const Rigid3d truth =
      Rigid3d::FromRotationVector({0.0, 0.5, 0.0}, {0.0, 0.0, 0.0});
  options.path_from_cam = truth;
  const SyntheticDataset turned(options);
  for (const std::string& name : TrackerNames()) {
    Odometry odometry(OdometryOptions(),
                      MakeTracker(name, PartsFor(dataset.camera().camera)));
    odometry.Track(dataset.Read(0));
    const TrackedFrame tracked = odometry.Track(turned.Read(1));
    EXPECT_EQ(tracked.status, TrackingStatus::kOk) << name << tracked.reason;
    EXPECT_FALSE(tracked.relocalised) << name;
    EXPECT_LT(ErrorOf(tracked.world_from_cam, truth).translation, 0.001)
        << name;
  }
}

// Where the current frame has no depth, matches cannot be used, but what they
// show agrees.
TEST(OdometryTest, HolesInDepthDoNotContradict) {
  const SyntheticDataset dataset = Room("xyz", 30);
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  for (int i = 0; i < 30; ++i) {
    Frame frame = dataset.Read(i).Clone();
    constexpr int kSide = 24;  // px; in each frame other squares are missing
    for (int y = 0; y < frame.depth.rows; ++y) {
      for (int x = 0; x < frame.depth.cols; ++x) {
        if ((x / kSide + y / kSide + i) % 5 >= 2) {
          frame.depth.at<uint16_t>(y, x) = Frame::kNoDepth;
        }
      }
    }
    const TrackedFrame tracked = odometry.Track(frame);
    EXPECT_EQ(tracked.status, TrackingStatus::kOk) << i << tracked.reason;
  }
}

// The second frame is far from the first; only the guess makes it easy to find.
TEST(OdometryTest, AMotionGuessIsTriedFirst) {
  const SyntheticDataset dataset = Room("pan_tilt", 40);
  const Frame first = dataset.Read(0);
  const Frame second = dataset.Read(8);
  const Rigid3d truth =
      dataset.WorldFromCam(8).Inverse() * dataset.WorldFromCam(0);
  ASSERT_GT(truth.Angle(), 3.0 * M_PI / 180.0) << "the test is vacuous";
  const Rigid3d wrong = truth.Inverse();
  for (const Rigid3d& guess : {truth, wrong}) {
    Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
    odometry.Track(first);
    const TrackedFrame tracked = odometry.Track(second, &guess);
    EXPECT_EQ(tracked.status, TrackingStatus::kOk) << tracked.reason;
    const Rigid3d error = truth * tracked.world_from_cam;
    EXPECT_LE(error.translation.norm(), 0.01) << "believed a wrong guess";
    EXPECT_LE(error.Angle(), 0.3 * M_PI / 180.0);
  }
}

// A camera that returns along its path: references change, also to earlier
// ones. Frames have no numbers.
TEST(OdometryTest, EveryTrackedFrameCarriesItsEdges) {
  const SyntheticDataset dataset = Room("pan_tilt", 60);
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  std::vector<TrackedFrame> frames;
  int references = 0, returns = 0;
  for (int i = 0; i < dataset.size(); ++i) {
    Frame frame = dataset.Read(i);
    frame.index = 0;
    frames.push_back(odometry.Track(frame));
    const TrackedFrame& tracked = frames.back();
    ASSERT_EQ(tracked.index, i);
    ASSERT_EQ(tracked.edges.empty(), i == 0) << i;
    references += tracked.is_reference;
    returns += tracked.edges.size() > 1;
    for (size_t k = 0; k < tracked.edges.size(); ++k) {
      const RelativePose& edge = tracked.edges[k];
      EXPECT_EQ(edge.cur, i);
      ASSERT_LT(edge.ref, i);
      EXPECT_TRUE(frames[edge.ref].is_reference);
      EXPECT_GT(edge.covariance.ldlt().vectorD().minCoeff(), 0.0);
      const Rigid3d truth =
          dataset.WorldFromCam(i).Inverse() * dataset.WorldFromCam(edge.ref);
      const Rigid3d error = edge.cur_from_ref * truth.Inverse();
      EXPECT_LE(error.translation.norm(), 0.005) << i;
      EXPECT_LE(error.Angle(), 0.3 * M_PI / 180.0) << i;
      if (k > 0) continue;
      EXPECT_EQ(edge.ref, tracked.reference);
      const Rigid3d pose =
          frames[edge.ref].world_from_cam * edge.cur_from_ref.Inverse();
      EXPECT_LE((pose.Inverse() * tracked.world_from_cam).translation.norm(),
                1e-12);
    }
  }
  EXPECT_GE(references, 5) << "the test is vacuous";
  EXPECT_GE(returns, 1) << "the test is vacuous";
}

// Of images that a driver has sent again, one is of another time than the
// other.
TEST(OdometryTest, FramesThatRepeatAnImageAreNoReference) {
  constexpr int kFrames = 60, kEvery = 5;
  const SyntheticDataset dataset = Room("handheld", kFrames);
  Odometry odometry = MakeOdometry(dataset.camera().camera, "tukey");
  cv::Mat gray;
  for (int i = 0; i < kFrames; ++i) {
    Frame frame = dataset.Read(i);
    const cv::Mat taken = frame.gray;
    const bool is_repeated = i % kEvery == kEvery - 1;
    if (is_repeated) frame.gray = gray;
    gray = taken;
    const TrackedFrame tracked = odometry.Track(frame);
    if (is_repeated) {
      EXPECT_EQ(tracked.status, TrackingStatus::kDegraded) << i;
      EXPECT_FALSE(tracked.is_reference) << i;
      continue;
    }
    EXPECT_EQ(tracked.status, TrackingStatus::kOk) << i << tracked.reason;
    if (i == 0) continue;
    EXPECT_NE(tracked.reference % kEvery, kEvery - 1) << i;
    const RelativePose& edge = tracked.edges.front();
    const Rigid3d truth =
        dataset.WorldFromCam(i).Inverse() * dataset.WorldFromCam(edge.ref);
    EXPECT_LE(ChiSquare(edge, truth, {}), kWrongChiSquare) << i;
  }
  EXPECT_EQ(odometry.repeated().color, kFrames / kEvery);
  EXPECT_EQ(odometry.repeated().depth, 0);
}

}  // namespace
}  // namespace rgbd_pose
