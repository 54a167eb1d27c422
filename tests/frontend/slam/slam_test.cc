// Runs SLAM on rendered images and compares map and path with the truth.

#include "frontend/slam/slam.h"

#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/util/input_error.h"
#include "frontend/frame/frame_rectifier.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "tests/support/motion_error.h"
#include "tests/support/shutter_sequence.h"
#include "tests/support/track_sequence.h"

namespace rgbd_pose {
namespace {

constexpr int kFrames = 60;

// Half the usual width and height, which takes a quarter of the time.
RgbdCamera SmallCamera() {
  RgbdCamera camera;
  camera.camera = {320, 240, 262.5, 262.5, 159.5, 119.5};
  return camera;
}

// A sequence that is rendered once.
struct WalkSequence {
  WalkSequence() {
    SyntheticOptions options;
    options.path = "handheld";
    options.frames = kFrames;
    options.camera = SmallCamera();
    const SyntheticDataset dataset(options);
    for (int i = 0; i < kFrames; ++i) {
      frames.push_back(dataset.Read(i));
      truth.push_back(dataset.WorldFromCam(i));
    }
    black = frames[0];
    black.gray = cv::Mat(black.gray.size(), CV_8UC1, cv::Scalar(0));
    black.depth = cv::Mat(black.depth.size(), CV_16UC1, cv::Scalar(0));
  }

  std::vector<Frame> frames;
  std::vector<Rigid3d> truth;
  Frame black;
};

const WalkSequence& Walk() {
  static const WalkSequence sequence;
  return sequence;
}

// Plays frames of the walk at 30 Hz; index -1 is a black frame.
class Player {
 public:
  explicit Player(const SlamSettings& settings = {})
      : slam(OdometrySettings(), settings, SmallCamera()) {}

  void Play(const std::vector<int>& order) {
    for (const int i : order) {
      Frame frame = TakenAgain(i < 0 ? Walk().black : Walk().frames[i], count);
      frame.timestamp = 1000.0 + (count++) / 30.0;
      frames.push_back(slam.Track(frame));
      shown.push_back(i);
    }
  }

  // Translation error (m) of the k-th frame played, in a map whose world is the
  // camera of frame `origin`.
  double Error(int k, int origin = 0) const {
    const Rigid3d expected =
        Walk().truth[origin].Inverse() * Walk().truth[shown[k]];
    return ErrorOf(frames[k].map_from_cam(), expected).translation;
  }

  Slam slam;
  std::vector<SlamFrame> frames;
  std::vector<int> shown;
  int count = 0;
};

std::vector<int> Range(int begin, int end) {
  std::vector<int> range;
  const int step = begin < end ? 1 : -1;
  for (int i = begin; i != end; i += step) range.push_back(i);
  return range;
}

TEST(SlamTest, MapsTheWalkAndItsOdometryNeverJumps) {
  Player player;
  player.Play(Range(0, kFrames));
  player.Play(Range(kFrames - 1, -1));
  int pairs = 0;
  for (size_t k = 1; k < player.frames.size(); ++k) {
    const SlamFrame& frame = player.frames[k];
    EXPECT_EQ(frame.tracked.status, TrackingStatus::kOk);
    EXPECT_EQ(frame.segment, 0);
    EXPECT_LT(player.Error(k), 0.005) << k;
    pairs += frame.pairs;
    const Rigid3d step =
        player.frames[k - 1].odom_from_cam.Inverse() * frame.odom_from_cam;
    const Rigid3d expected = Walk().truth[player.shown[k - 1]].Inverse() *
                             Walk().truth[player.shown[k]];
    EXPECT_LT(ErrorOf(step, expected).translation, 0.003) << k;
  }
  EXPECT_GT(pairs, 1);
  player.slam.Finish();
  const Trajectory path = player.slam.Path();
  ASSERT_EQ(path.size(), player.frames.size());
  EXPECT_LT(ErrorOf(path.back().world_from_cam, Rigid3d()).translation, 0.002);
  const KeyframeMap map = player.slam.Map();
  EXPECT_EQ(map.Check(), "");
  EXPECT_EQ(player.slam.Covariances().size(), map.keyframes.size());
  EXPECT_GT(map.keyframes.size(), 2U);
  // Their poses are stored twice: in the pose graph and in the SLAM state.
  for (const Keyframe& keyframe : map.keyframes) {
    const Rigid3d& pose = path.at(keyframe.id).world_from_cam;
    EXPECT_LT((pose.translation - keyframe.world_from_cam.translation).norm(),
              1e-12)
        << keyframe.id;
  }
}

// The map grows with the area covered, not with time.
TEST(SlamTest, ToAndFroNeedsNoMoreKeyframes) {
  Player player;
  player.Play(Range(0, kFrames));
  player.slam.Finish();
  const size_t once = player.slam.Map().keyframes.size();
  for (int lap = 0; lap < 4; ++lap) {
    player.Play(Range(kFrames - 1, -1));
    player.Play(Range(0, kFrames));
  }
  player.slam.Finish();
  EXPECT_GE(once, 3U);
  EXPECT_LE(player.slam.Map().keyframes.size(), once + 2);
}

TEST(SlamTest, AKidnappedCameraIsFoundInTheMap) {
  Player player;
  player.Play(Range(0, kFrames));
  player.Play(std::vector<int>(5, -1));
  const size_t back = player.frames.size();
  player.Play(std::vector<int>(25, 5));
  int found = 0;
  for (size_t k = back; k < player.frames.size(); ++k) {
    if (player.frames[k].tracked.status != TrackingStatus::kOk ||
        player.frames[k].segment != 0) {
      continue;
    }
    ++found;
    EXPECT_LT(player.Error(k), 0.01) << k;
  }
  EXPECT_GT(found, 5);
}

// Two seconds of darkness start a new segment, which is joined to the old one
// as soon as the two overlap.
TEST(SlamTest, SegmentsThatMeetAreJoined) {
  Player player;
  player.Play(Range(30, kFrames));
  player.Play(std::vector<int>(60, -1));
  const size_t back = player.frames.size();
  player.Play(Range(0, kFrames));
  int joined = 0;
  for (const SlamFrame& frame : player.frames) joined += frame.joined;
  player.slam.Finish();
  EXPECT_EQ(player.frames.back().segment, 0);
  EXPECT_LT(player.Error(player.frames.size() - 1, 30), 0.005);
  // In the end, frames of the new segment are in the world of the old one.
  const Trajectory path = player.slam.Path();
  const size_t first = path.size() - (player.frames.size() - back);
  ASSERT_LT(first, path.size());
  const Rigid3d expected = Walk().truth[30].Inverse() * Walk().truth[59];
  EXPECT_LT(ErrorOf(path.back().world_from_cam, expected).translation, 0.005);
  EXPECT_EQ(player.slam.PathSegments(), std::vector<int>(path.size(), 0));
}

TEST(SlamTest, AMapThatIsHeldIsTrackedInAndStaysAsItIs) {
  Player first;
  first.Play(Range(0, kFrames));
  first.slam.Finish();
  const KeyframeMap map = first.slam.Map();

  Player second;
  second.slam.Load(map, /*is_held=*/true);
  second.Play({-1});
  second.Play(Range(20, kFrames));
  EXPECT_NE(second.frames[0].segment, 0) << "a lost frame is not in the map";
  EXPECT_NE(second.frames[1].segment, 0);
  EXPECT_EQ(second.frames.back().segment, 0);
  EXPECT_LT(second.Error(second.frames.size() - 1), 0.005);
  second.slam.Finish();
  // In the end, the frames before are in the map, too.
  EXPECT_EQ(second.slam.PathSegments(),
            std::vector<int>(second.slam.Path().size(), 0));
  const KeyframeMap after = second.slam.Map();
  ASSERT_GE(after.keyframes.size(), map.keyframes.size());
  for (size_t k = 0; k < map.keyframes.size(); ++k) {
    EXPECT_EQ(after.keyframes[k].id, map.keyframes[k].id);
    EXPECT_EQ(after.keyframes[k].world_from_cam.translation,
              map.keyframes[k].world_from_cam.translation);
  }
}

TEST(SlamTest, TwoMapsOfOnePlaceBecomeOne) {
  std::vector<KeyframeMap> maps;
  for (const auto& range : {Range(0, 45), Range(15, kFrames)}) {
    Player player;
    player.Play(range);
    player.slam.Finish();
    maps.push_back(player.slam.Map());
  }
  Player player;
  for (const KeyframeMap& map : maps) player.slam.Load(map, false);
  player.Play(Range(20, 50));
  player.Play(Range(50, 10));
  player.slam.Finish();
  for (const Keyframe& keyframe : player.slam.Map().keyframes) {
    EXPECT_EQ(keyframe.segment, 0) << keyframe.id;
  }
}

TEST(SlamTest, RefusesAMapOfAnotherCamera) {
  KeyframeMap map;
  map.camera = Camera();
  Player player;
  try {
    player.slam.Load(map, false);
    FAIL() << "no error";
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "map: the map's images have 640 x 480 pixels, the camera's "
                 "320 x 240; give the camera that made the map, or make a new "
                 "one");
  }
}

// The header of a damaged image may be sound.
TEST(SlamTest, AMapWithADamagedImageLeavesNothingBehind) {
  Player first;
  first.Play(Range(0, kFrames));
  first.slam.Finish();
  KeyframeMap map = first.slam.Map();
  ASSERT_GT(map.keyframes.size(), 1u);
  ASSERT_FALSE(map.edges.empty());
  std::shared_ptr<const PngBytes>& image = map.keyframes.back().images.depth;
  image = std::make_shared<const PngBytes>(image->bytes.substr(0, 60));
  Player second;
  EXPECT_THROW(second.slam.Load(map, false), InputError);
  EXPECT_TRUE(second.slam.links().empty());
  second.Play(Range(0, kFrames));
  second.slam.Finish();
  EXPECT_EQ(second.slam.Map().keyframes.size(),
            first.slam.Map().keyframes.size());
}

TEST(SlamTest, RefusesOptionsThatMakeNoSense) {
  SlamSettings settings;
  settings.mapping.max_pairs = 0;
  EXPECT_THROW(Player player(settings), InputError);
  settings = {};
  settings.mapping.min_pair_share = std::nan("");
  EXPECT_THROW(Player player(settings), InputError);
  settings = {};
  for (const int delay : {-1, std::numeric_limits<int>::max()}) {
    settings.update_delay = delay;
    EXPECT_THROW(Player player(settings), InputError);
  }
}

// Frames of a camera with rolling shutters.
struct RollingWalk {
  RollingWalk() {
    SyntheticOptions options;
    options.path = "handheld";
    options.frames = 30;
    options.camera = SmallCamera();
    options.color_shutter = {-0.0075, 0.028};
    options.depth_shutter = {-0.018, 0.028};
    const SyntheticDataset dataset(options);
    for (int i = 0; i < dataset.size(); ++i) frames.push_back(dataset.Read(i));
    settings.odometry.max_flow_px = 15.0;  // several keyframes
  }

  std::vector<Frame> frames;
  OdometrySettings settings;
};

// The odometry keeps what was measured, with the velocity that the next frame
// tells. The map stores it rectified to one moment with this velocity.
TEST(SlamTest, KeyframesOfRollingShuttersAreOfOneMoment) {
  const RollingWalk walk;
  Slam slam(walk.settings, {}, SmallCamera());
  FrameRectifier rectifier(SmallCamera().camera);
  std::map<int, Frame> rectified;
  for (const Frame& frame : walk.frames) {
    const TrackedFrame tracked = slam.Track(frame).tracked;
    ASSERT_EQ(tracked.status, TrackingStatus::kOk) << tracked.reason;
    for (int id = 0; id < tracked.index; ++id) {
      const Keyframe* const kept = slam.odometry().FindKeyframe(id);
      if (kept == nullptr) continue;
      EXPECT_EQ(cv::norm(kept->frame.gray, walk.frames[id].gray, cv::NORM_INF),
                0.0);
      rectified[id] =
          rectifier.Rectify(kept->frame, kept->reference_from_stamp);
    }
  }
  slam.Finish();
  int compared = 0;
  for (const Keyframe& keyframe : slam.Map().keyframes) {
    if (rectified.count(keyframe.id) == 0) continue;  // the very last frame
    const Frame& expected = rectified.at(keyframe.id);
    const Frame stored = keyframe.images.Restore();
    const Frame& measured = walk.frames[keyframe.id];
    EXPECT_TRUE(stored.IsOneMoment());
    EXPECT_EQ(cv::norm(stored.gray, expected.gray, cv::NORM_INF), 0.0);
    EXPECT_EQ(cv::norm(stored.depth, expected.depth, cv::NORM_INF), 0.0);
    EXPECT_GT(cv::norm(stored.gray, measured.gray, cv::NORM_INF), 50.0);
    EXPECT_GT(cv::norm(stored.depth, measured.depth, cv::NORM_INF), 50.0);
    ++compared;
  }
  EXPECT_GE(compared, 3);
}

// The map is solved in another thread. The result depends neither on the
// threads that prepare frames nor on timing.
TEST(SlamTest, RollingShuttersGiveTheSameBytesForAnyThreads) {
  const RollingWalk walk;
  std::string first;
  for (const int threads : {1, 1, 3}) {
    Slam slam(walk.settings, {}, SmallCamera());
    std::vector<PreparedFrame> frames;
    std::vector<std::future<void>> ahead;
    for (const Frame& frame : walk.frames) {
      if (threads == 1) {
        slam.Track(frame);
      } else {
        frames.emplace_back(frame);
        ahead.push_back(std::async(
            std::launch::async,
            [&slam, frame = frames.back()] { slam.Prepare(frame); }));
      }
    }
    for (size_t i = 0; i < frames.size(); ++i) {
      ahead[i].get();
      slam.Track(frames[i]);
    }
    slam.Finish();
    std::string text = FormatTrajectory(slam.Path());
    for (const Keyframe& keyframe : slam.Map().keyframes) {
      text += std::to_string(cv::sum(keyframe.images.Restore().gray)[0]) + "\n";
    }
    if (first.empty()) first = text;
    EXPECT_EQ(text, first) << threads;
  }
}

// What the velocity of a keyframe has wrong is in all its pairs, so that their
// number does not make it smaller. That of the first one is in all poses.
TEST(SlamTest, CovariancesKnowThatPairsShareTheTimingOfAKeyframe) {
  double chi2 = 0.0;
  int count = 0;
  for (const int seed : {1, 2, 3, 4, 5}) {
    SyntheticOptions options = ShutterOptions("handheld", RollingShutters(1.0));
    options.seed = seed;
    const SyntheticDataset dataset(options);
    Slam slam(OdometrySettings(), SlamSettings(), dataset.camera());
    for (int i = 0; i < kFrames; ++i) slam.Track(dataset.Read(i));
    slam.Finish();
    const KeyframeMap map = slam.Map();
    const std::vector<MotionMatrix> covariances = slam.Covariances();
    ASSERT_EQ(covariances.size(), map.keyframes.size());
    const Rigid3d first = dataset.WorldFromCam(map.keyframes[0].id);
    for (size_t k = 1; k < map.keyframes.size(); ++k) {
      const Keyframe& keyframe = map.keyframes[k];
      chi2 += SquaredMahalanobisDistance(
          keyframe.world_from_cam.Inverse(),
          dataset.WorldFromCam(keyframe.id).Inverse() * first, covariances[k]);
      ++count;
    }
  }
  ASSERT_GT(count, 5);
  EXPECT_GT(chi2 / (6.0 * count), 0.1);
  EXPECT_LT(chi2 / (6.0 * count), 1.0);
}

}  // namespace
}  // namespace rgbd_pose
