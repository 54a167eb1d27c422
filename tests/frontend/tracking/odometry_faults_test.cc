// Odometry with a camera that is covered, knocked or looks at a moving object:
// it must report this, must not be certain of a wrong pose, and must recover.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_path.h"
#include "frontend/simulation/synthetic_renderer.h"
#include "frontend/simulation/synthetic_scene.h"
#include "frontend/simulation/synthetic_sensor.h"
#include "frontend/tracking/odometry.h"
#include "tests/support/synthetic_faults.h"
#include "tests/support/tracker_parts.h"

namespace rgbd_pose {
namespace {

// Limits for the error of poses with status ok: the drift of a few seconds
// (less than half of this in the worst sequence without faults), far below the
// error of a pose that follows the box or a false match.
constexpr double kMaxShift = 0.020;      // m
constexpr double kMaxShiftShare = 0.01;  // of the path so far
constexpr double kMaxTurnDeg = 0.5;
constexpr int kRecoveryFrames = 5;

// A frame and the error of its pose; both poses are relative to the first
// frame.
struct Outcome {
  TrackedFrame tracked;
  double shift = 0.0;      // m
  double turn_deg = 0.0;   // degrees
  double max_shift = 0.0;  // m

  bool ok() const { return tracked.status == TrackingStatus::kOk; }
  bool lost() const { return tracked.status == TrackingStatus::kLost; }
  bool right() const { return shift <= max_shift && turn_deg <= kMaxTurnDeg; }
};

std::ostream& operator<<(std::ostream& out, const Outcome& outcome) {
  return out << "frame " << outcome.tracked.index << " is "
             << ToString(outcome.tracked.status) << " ("
             << outcome.tracked.reason << "), off by " << 1e3 * outcome.shift
             << " mm, " << outcome.turn_deg << " deg, with "
             << outcome.tracked.inliers << " of " << outcome.tracked.matches
             << " matches";
}

// The results of one tracker along a sequence.
class Run {
 public:
  Run(const std::string& tracker, const Dataset& dataset)
      : tracker_(tracker),
        odometry_(OdometryOptions(),
                  MakeTracker(tracker, PartsFor(dataset.camera().camera))) {}

  // `expected` is the true pose.
  void Track(const Frame& frame, const Rigid3d& expected, double way) {
    Outcome outcome;
    outcome.tracked = odometry_.Track(frame);
    const Rigid3d error = expected.Inverse() * outcome.tracked.world_from_cam;
    outcome.shift = error.translation.norm();
    outcome.turn_deg = error.Angle() * 180.0 / M_PI;
    outcome.max_shift = kMaxShift + kMaxShiftShare * way;
    outcomes_.push_back(outcome);
  }

  const std::string& tracker() const { return tracker_; }
  const std::vector<Outcome>& outcomes() const { return outcomes_; }

 private:
  std::string tracker_;
  Odometry odometry_;
  std::vector<Outcome> outcomes_;
};

using Check = std::function<void(const std::string& tracker,
                                 const std::vector<Outcome>& outcomes)>;

// Runs every tracker along a sequence whose frames are rendered only once.
void ForEveryTracker(const Dataset& dataset, const Trajectory& truth,
                     const Check& check) {
  std::deque<Run> runs;
  for (const std::string& tracker : TrackerNames()) {
    runs.emplace_back(tracker, dataset);
  }
  double way = 0.0;
  const Rigid3d first_from_world = truth[0].world_from_cam.Inverse();
  for (int i = 0; i < dataset.size(); ++i) {
    if (i > 0) {
      way += (truth[i].world_from_cam.translation -
              truth[i - 1].world_from_cam.translation)
                 .norm();
    }
    const Frame frame = dataset.Read(i);
    for (Run& run : runs) {
      run.Track(frame, first_from_world * truth[i].world_from_cam, way);
    }
  }
  for (const Run& run : runs) {
    SCOPED_TRACE(run.tracker());
    EXPECT_EQ(run.outcomes().size(), static_cast<size_t>(dataset.size()));
    check(run.tracker(), run.outcomes());
  }
}

void ForEveryTracker(const std::string& path, int frames,
                     const std::vector<Fault>& faults, const Check& check) {
  SyntheticOptions options;
  options.path = path;
  options.frames = frames;
  const FaultyDataset dataset(options, faults);
  ForEveryTracker(dataset, dataset.ground_truth(), check);
}

void ExpectNoWrongOk(const std::vector<Outcome>& outcomes) {
  for (const Outcome& outcome : outcomes) {
    EXPECT_TRUE(!outcome.ok() || outcome.right()) << outcome;
  }
}

void ExpectNeverLost(const std::vector<Outcome>& outcomes) {
  for (const Outcome& outcome : outcomes)
    EXPECT_FALSE(outcome.lost()) << outcome;
}

void ExpectLost(const std::vector<Outcome>& outcomes, int first, int end) {
  for (int i = first; i < end; ++i)
    EXPECT_TRUE(outcomes[i].lost()) << outcomes[i];
}

// Expects ok poses from one of the first frames after the fault on.
void ExpectRecovery(const std::vector<Outcome>& outcomes, int end) {
  const auto after = outcomes.begin() + end;
  const auto ok = std::find_if(after, after + kRecoveryFrames,
                               [](const Outcome& o) { return o.ok(); });
  if (ok == after + kRecoveryFrames) {
    ADD_FAILURE() << "not ok again: " << *(ok - 1);
    return;
  }
  EXPECT_TRUE(ok->right()) << *ok;
  EXPECT_TRUE(outcomes.back().ok() && outcomes.back().right())
      << "at the end: " << outcomes.back();
}

TEST(OdometryFaultsTest, BlackFramesAreLeftBehind) {
  ForEveryTracker(
      "circle", 50, {{FaultKind::kBlack, 15, 35}},
      [](const std::string& tracker, const std::vector<Outcome>& outcomes) {
        // Trackers that use depth need not be lost.
        if (tracker == "features") ExpectLost(outcomes, 15, 35);
        ExpectNoWrongOk(outcomes);
        ExpectRecovery(outcomes, 35);
      });
}

TEST(OdometryFaultsTest, CoveredDepthIsLeftBehind) {
  ForEveryTracker(
      "circle", 60, {{FaultKind::kCovered, 15, 45}},  // 1 s
      [](const std::string& tracker, const std::vector<Outcome>& outcomes) {
        // Pixel costs use the depth of the reference.
        if (tracker == "features") {
          ExpectLost(outcomes, 15, 45);
        } else {
          ExpectNeverLost(outcomes);
        }
        ExpectNoWrongOk(outcomes);
        ExpectRecovery(outcomes, 45);
      });
}

// Neither gray levels nor depths give information.
TEST(OdometryFaultsTest, ACoveredLensIsNotFollowed) {
  ForEveryTracker("circle", 50,
                  {{FaultKind::kBlack, 15, 35}, {FaultKind::kCovered, 15, 35}},
                  [](const std::string&, const std::vector<Outcome>& outcomes) {
                    ExpectLost(outcomes, 15, 35);
                    ExpectRecovery(outcomes, 35);
                  });
}

TEST(OdometryFaultsTest, FindsItselfAfterAKnock) {
  constexpr int kKnock = 20;
  ForEveryTracker("circle", 40, {{FaultKind::kTurned, kKnock}},
                  [](const std::string&, const std::vector<Outcome>& outcomes) {
                    ExpectNoWrongOk(outcomes);
                    ExpectRecovery(outcomes, kKnock);
                  });
}

TEST(OdometryFaultsTest, DoesNotFollowABoxThatFillsMuchOfTheImage) {
  ForEveryTracker("circle", 60, {{FaultKind::kBox, 15, 50}},
                  [](const std::string&, const std::vector<Outcome>& outcomes) {
                    ExpectNeverLost(outcomes);
                    ExpectNoWrongOk(outcomes);
                    ExpectRecovery(outcomes, 50);
                  });
}

// A pan that reaches 48 deg/s, 44 px from frame to frame at 10 Hz.
TEST(OdometryFaultsTest, TracksAThirdOfTheFrames) {
  ForEveryTracker("pan_tilt", 120, {{FaultKind::kThinned, 15, 105}},
                  [](const std::string&, const std::vector<Outcome>& outcomes) {
                    ASSERT_EQ(outcomes.size(), 60u);
                    ExpectNeverLost(outcomes);
                    ExpectNoWrongOk(outcomes);
                    ExpectRecovery(outcomes, 15 + 30);
                  });
}

TEST(OdometryFaultsTest, TracksThroughStepsOfTheExposure) {
  for (const double gain : {2.0, 0.5}) {
    SCOPED_TRACE("gain " + std::to_string(gain));
    ForEveryTracker(
        "circle", 40, {{FaultKind::kGain, 15, 30, gain}},
        [](const std::string&, const std::vector<Outcome>& outcomes) {
          ExpectNeverLost(outcomes);
          ExpectNoWrongOk(outcomes);
          ExpectRecovery(outcomes, 15);
          ExpectRecovery(outcomes, 30);
        });
  }
}

// Half the resolution: blurred frames take several renderings each.
TEST(OdometryFaultsTest, TracksAFastHandWithBlurAndDriftingExposure) {
  SyntheticOptions options;
  options.path = "handheld";
  options.frames = 150;
  options.exposure_s = 0.01;
  options.exposure_drift = 0.3;
  options.camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5, 0, 0, 0};
  const SyntheticDataset dataset(options);
  ForEveryTracker(dataset, dataset.ground_truth(),
                  [](const std::string&, const std::vector<Outcome>& outcomes) {
                    ASSERT_EQ(outcomes.size(), 150u);
                    ExpectNeverLost(outcomes);
                    ExpectNoWrongOk(outcomes);
                  });
}

// One view with new noise in every frame: equal to SyntheticDataset with path
// "still", but rendered only once.
class NoisyView : public Dataset {
 public:
  explicit NoisyView(int frames) : frames_(frames) {
    const Rigid3d pose = FindSyntheticPath("still")(0.0, 1.0);
    view_ = Renderer(MakeScene("room", 1), camera_.camera).Render(pose);
  }

  int size() const override { return frames_; }
  double timestamp(int index) const override { return index / 30.0; }
  const RgbdCamera& camera() const override { return camera_; }

  Frame Read(int index) const override {
    const uint64_t key = static_cast<uint64_t>(index) << 41;
    cv::Mat color = view_.color.clone();
    AddColorNoise(key, &color);
    Frame frame;
    frame.index = index;
    frame.timestamp = timestamp(index);
    cv::cvtColor(color, frame.gray, cv::COLOR_BGR2GRAY);
    frame.depth = EncodeDepth(
        MeasureDepth(view_.depth, camera_.camera.fx, key + (uint64_t{1} << 40)),
        camera_.depth_scale);
    return frame;
  }

 private:
  int frames_;
  RgbdCamera camera_;
  Rendering view_;
};

TEST(OdometryFaultsTest, NoiseAloneDoesNotMoveAStillCamera) {
  constexpr int kFrames = 300;  // 10 s
  const NoisyView dataset(kFrames);
  Trajectory truth;
  for (int i = 0; i < kFrames; ++i) {
    truth.push_back({dataset.timestamp(i), Rigid3d()});
  }
  // The noise of a frame, with hundreds of corners of 0.5 px, is a quarter of
  // this limit. A larger error would be drift.
  ForEveryTracker(dataset, truth,
                  [](const std::string&, const std::vector<Outcome>& outcomes) {
                    for (const Outcome& outcome : outcomes) {
                      EXPECT_TRUE(outcome.ok()) << outcome;
                      EXPECT_LT(outcome.shift, 0.001) << outcome;
                      EXPECT_LT(outcome.turn_deg, 0.05) << outcome;
                    }
                  });
}

}  // namespace
}  // namespace rgbd_pose
