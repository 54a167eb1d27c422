// Real sequences, if they are available.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "core/evaluation/consistency.h"
#include "core/evaluation/evaluation.h"
#include "frontend/files/camera_file.h"
#include "frontend/sources/open_source.h"
#include "tests/support/track_sequence.h"

namespace rgbd_pose {
namespace {

class RealSequenceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("RGBD_POSE_TEST_DATA");
    if (folder == nullptr) {
      GTEST_SKIP() << "RGBD_POSE_TEST_DATA does not name a folder of real "
                      "sequences";
    }
    folder_ = folder;
  }

  std::unique_ptr<Dataset> Open(const std::string& sequence) const {
    SourceOptions options;
    options.path = folder_ + "/" + sequence;
    options.camera = ResolveCamera(options.path + "/camera.yaml");
    return OpenTum(options);
  }

  std::string folder_;
};

TEST_F(RealSequenceTest, RedKitchenIsTrackedThroughout) {
  const TrackedSequence run = TrackAll(*Open("redkitchen400"), "tukey");
  EXPECT_EQ(run.frames.size(), 400u);
  EXPECT_EQ(run.Count(TrackingStatus::kLost), 0);
  const EvaluationReport report =
      Evaluate(run.trajectory,
               ReadTrajectory(folder_ + "/redkitchen400/groundtruth.txt"), {});
  EXPECT_LE(report.ate.rmse, 0.060);
  EXPECT_LE(report.rpe_seconds.translation.rmse, 0.050);
}

TEST_F(RealSequenceTest, AFarHallIsNotLostAndStandsStill) {
  const TrackedSequence run = TrackAll(*Open("tum_fr2_hall50"), "tukey");
  EXPECT_EQ(run.Count(TrackingStatus::kLost), 0);
}

TEST_F(RealSequenceTest, FastRotationIsTracked) {
  const TrackedSequence run = TrackAll(*Open("tum_fr1_360_5"), "tukey");
  EXPECT_EQ(run.Count(TrackingStatus::kLost), 0);
}

TEST_F(RealSequenceTest, Freiburg1IsWithinAFewMillimetres) {
  // The depth stamps are partly guessed (SOURCE.txt), the third one wrongly:
  // its frame fits worse than without stamps, and better one image later.
  OdometryOptions options;
  options.shutter = ShutterUse::kNone;
  const TrackedSequence run =
      TrackAll(*Open("tum_fr1_xyz_3"), "tukey", options);
  EXPECT_EQ(run.Count(TrackingStatus::kOk), 3);
  const EvaluationReport report =
      Evaluate(run.trajectory,
               ReadTrajectory(folder_ + "/tum_fr1_xyz_3/groundtruth.txt"), {});
  EXPECT_LE(report.rpe_frame.translation.rmse, 0.01);
}

// Fast turns with blur. Without what errors of neighbouring features have in
// common, eight frames are wrong.
TEST_F(RealSequenceTest, AnOkOnFastTurnsIsHardlyEverWrong) {
  SourceOptions source;
  source.path = folder_ + "/tum_fr1_rpy250";
  source.camera = ResolveCamera("tum_fr1");
  const auto dataset = OpenTum(source);
  Odometry odometry({},
                    MakeTracker("hybrid", PartsFor(dataset->camera().camera)));
  std::vector<RelativePose> ok_edges;
  std::vector<double> times;
  for (int i = 0; i < dataset->size(); ++i) {
    const TrackedFrame tracked = odometry.Track(dataset->Read(i));
    times.push_back(tracked.timestamp);
    if (tracked.status != TrackingStatus::kOk || tracked.edges.empty())
      continue;
    ok_edges.push_back(tracked.edges.front());
  }
  const Consistency found =
      Judge(ok_edges, times, ReadTrajectory(source.path + "/groundtruth.txt"),
            {0.002, 0.2 * M_PI / 180.0});
  EXPECT_GT(found.count, 190);
  EXPECT_LE(found.wrong, 4);
  EXPECT_LT(found.nees, 1.6);
}

}  // namespace
}  // namespace rgbd_pose
