// Calibrates from rendered images and compares the result with the true camera.

#include "frontend/calibration/calibration.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/util/input_error.h"
#include "frontend/calibration/calibration_data.h"
#include "frontend/calibration/calibration_run.h"
#include "frontend/calibration/calibration_verdict.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/slam/slam.h"
#include "frontend/sources/frame_assembly.h"
#include "frontend/sources/tum_writer.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

using Status = CalibratedParameter::Status;

constexpr int kCalibrationFrames = 45;

std::vector<Frame> Render(const std::string& path, int frames,
                          const SyntheticOptions& simulated = {}) {
  SyntheticOptions options = simulated;
  options.path = path;
  options.frames = frames;
  const SyntheticDataset dataset(options);
  std::vector<Frame> result;
  for (int i = 0; i < frames; ++i) result.push_back(dataset.Read(i));
  return result;
}

// The input of a calibration. Shared by the tests: mapping takes seconds.
struct Mapped {
  Mapped(const std::vector<Frame>& frames, const RgbdCamera& camera)
      : first(camera) {
    Slam slam(CalibrationOdometry(), CalibrationSlam(), first);
    std::vector<SlamFrame> tracked;
    for (const Frame& frame : frames) {
      tracked.push_back(slam.Track(CorrectDepth(first, frame)));
    }
    slam.Finish();
    map = slam.Map();
    path = SmoothPath(tracked);
  }

  CalibrationResult Calibrate(CalibrationSettings settings = {},
                              int threads = 2) const {
    settings.max_views = 5000;
    return rgbd_pose::Calibrate(map, path, first, CalibrationOdometry(),
                                settings, {}, threads);
  }

  RgbdCamera first;
  KeyframeMap map;
  Trajectory path;
};

const std::vector<Frame>& Handheld() {
  static const std::vector<Frame> frames =
      Render("handheld", kCalibrationFrames);
  return frames;
}

RgbdCamera Wrong() {
  RgbdCamera wrong;
  wrong.camera.fx *= 1.02;
  wrong.camera.fy *= 1.02;
  wrong.camera.cx += 5.0;
  wrong.camera.cy -= 5.0;
  wrong.depth_correction.inverse_depth_offset = 0.01;
  wrong.depth_shutter.offset = -0.01;
  return wrong;
}

const Mapped& MappedWrongly() {
  static const Mapped mapped(Handheld(), Wrong());
  return mapped;
}

const CalibratedParameter& Of(const CalibrationResult& result,
                              CalibrationIndex k) {
  return result.parameters[k];
}

TEST(CalibrationTest, FindsWhatIsWrongOnAnyNumberOfThreads) {
  const CalibrationResult result = MappedWrongly().Calibrate({}, 3);
  EXPECT_TRUE(result.is_accepted) << result.reason;
  const Camera truth;
  EXPECT_NEAR(result.camera.camera.fx, truth.fx, 2e-3 * truth.fx);
  EXPECT_NEAR(result.camera.camera.fy, truth.fy, 2e-3 * truth.fy);
  EXPECT_NEAR(result.camera.camera.cx, truth.cx, 0.5);
  EXPECT_NEAR(result.camera.camera.cy, truth.cy, 0.5);
  EXPECT_NEAR(result.camera.depth_correction.inverse_depth_offset, 0.0, 2e-3);
  EXPECT_NEAR(result.camera.depth_shutter.offset, 0.0, 1e-3);
  // Parameters have the values of the camera, not their changes.
  EXPECT_EQ(Of(result, kInverseDepth).before, 0.01);
  EXPECT_EQ(Of(result, kInverseDepth).found,
            result.camera.depth_correction.inverse_depth_offset);
  EXPECT_EQ(Of(result, kDepthTime).before, -0.01);
  EXPECT_EQ(Of(result, kDepthTime).found, result.camera.depth_shutter.offset);
  EXPECT_LT(result.cost_after, result.cost_before);
  // The camera has its noise, too.
  ASSERT_TRUE(result.camera.depth_noise.has_value());
  EXPECT_EQ(result.camera.depth_noise->sigma(2.0),
            result.noise->model.sigma(2.0));
  // Parameters that were right are unchanged.
  EXPECT_EQ(result.camera.camera.k1, truth.k1);
  EXPECT_EQ(result.camera.color_shutter.readout, 0.0);
  EXPECT_TRUE(
      result.camera.depth_correction.depth_from_color.translation.isZero(0.0));
  // Images alone do not determine the scale of the world.
  EXPECT_EQ(Of(result, kDepthFactor).status, Status::kFixed);
  EXPECT_EQ(result.camera.depth_scale, Wrong().depth_scale);
  EXPECT_TRUE(result.scale_from.empty());

  const CalibrationResult one = MappedWrongly().Calibrate({}, 1);
  for (int k = 0; k < kCalibrationSize; ++k) {
    EXPECT_EQ(one.parameters[k].found, result.parameters[k].found);
    EXPECT_EQ(one.parameters[k].sigma, result.parameters[k].sigma);
  }
  EXPECT_EQ(one.cost_after, result.cost_after);
}

// The largest distance (px) between the images of a point in two cameras.
double LargestDifferencePx(const Camera& a, const Camera& b) {
  double largest = 0.0;
  for (double v = 20.0; v < a.height; v += 40.0) {
    for (double u = 20.0; u < a.width; u += 40.0) {
      const Eigen::Vector3d ray = a.Unproject({u, v}, 1.0);
      largest = std::max(largest, (b.Project(ray) - a.Project(ray)).norm());
    }
  }
  return largest;
}

TEST(CalibrationTest, FindsAllCoefficientsOfALens) {
  SyntheticOptions options;
  for (const LensModel model :
       {LensModel::kRational, LensModel::kEquidistant}) {
    RgbdCamera& truth = options.camera;
    truth.camera.SetDistortion(
        model, model == LensModel::kRational
                   ? std::vector<double>{0.15, -0.3, -0.003, 0.002, 0.15}
                   : std::vector<double>{-0.05, 0.05, -0.03, 0.01});
    RgbdCamera first = truth;
    first.camera.SetDistortion(model, std::vector<double>(4, 0.0));
    const CalibrationResult result =
        Mapped(Render("handheld", kCalibrationFrames, options), first)
            .Calibrate();
    EXPECT_TRUE(result.is_accepted) << result.reason;
    EXPECT_GT(LargestDifferencePx(truth.camera, first.camera), 3.0);
    EXPECT_LT(LargestDifferencePx(truth.camera, result.camera.camera), 0.5);
    // Parameters that this lens model lacks stay fixed.
    const bool is_fisheye = model == LensModel::kEquidistant;
    EXPECT_EQ(Of(result, kP1).status == Status::kFixed, is_fisheye);
    EXPECT_EQ(Of(result, kK4).status == Status::kFixed, !is_fisheye);
  }
}

TEST(CalibrationTest, WhatIsFixedStays) {
  CalibrationSettings settings;
  settings.fix = "centre,registration,depth_time_offset";
  const CalibrationResult result = MappedWrongly().Calibrate(settings);
  EXPECT_EQ(Of(result, kCx).status, Status::kFixed);
  EXPECT_EQ(Of(result, kCx).found, Wrong().camera.cx);
  EXPECT_EQ(Of(result, kDepthTime).found, Wrong().depth_shutter.offset);
  EXPECT_EQ(Of(result, kRotationY).found, 0.0);
  EXPECT_NE(Of(result, kFx).status, Status::kFixed);
  // k1 was right and must not compensate for parameters fixed at wrong values.
  EXPECT_EQ(result.camera.camera.k1, Camera().k1);
  settings.fix = "centre,size";
  EXPECT_THROW(MappedWrongly().Calibrate(settings), InputError);
}

TEST(CalibrationTest, KeepsACameraThatIsRight) {
  const CalibrationResult result = Mapped(Handheld(), RgbdCamera()).Calibrate();
  EXPECT_FALSE(result.is_accepted);
  EXPECT_FALSE(result.reason.empty());
  EXPECT_EQ(result.camera.camera.fx, Camera().fx);
}

SyntheticOptions RollingShutters() {
  SyntheticOptions options;
  options.color_shutter = {0.0, 0.028};
  options.depth_shutter = {-0.015, 0.022};
  return options;
}

// The readout (s) that the residuals lack: residuals are -flow times the time
// by which a row is late.
double ReadoutLeft(const CalibrationResult& result,
                   Eigen::Vector2d HeldOutResidual::*residual) {
  const double height = result.camera.camera.height;
  double along = 0.0, square = 0.0;
  for (const HeldOutResidual& r : result.residuals) {
    constexpr double kMostPx = 20.0;
    if ((r.*residual).norm() > kMostPx) continue;  // a wrong match
    const Eigen::Vector2d per_second = (r.v / height - 0.5) * r.flow;
    along -= (r.*residual).dot(per_second);
    square += per_second.squaredNorm();
  }
  return along / square;
}

TEST(CalibrationTest, FindsShuttersAndClocks) {
  // Fewer frames leave too few held-out pairs for the delay.
  const CalibrationResult result =
      Mapped(Render("handheld", 60, RollingShutters()), {}).Calibrate();
  EXPECT_TRUE(result.is_accepted) << result.reason;
  EXPECT_NEAR(result.camera.color_shutter.readout, 0.028, 3e-3);
  EXPECT_NEAR(result.camera.depth_shutter.readout, 0.022, 3e-3);
  EXPECT_NEAR(result.camera.depth_shutter.offset, -0.015, 1e-3);
  // Poses compensate most of it in the first camera.
  EXPECT_GT(ReadoutLeft(result, &HeldOutResidual::before), 1e-3);
  // A pair of keyframes more or less moves it by 0.2 ms.
  EXPECT_NEAR(ReadoutLeft(result, &HeldOutResidual::after), 0.0, 5e-4);
}

TEST(CalibrationTest, ACameraAtRestDeterminesNothing) {
  const CalibrationResult result =
      Mapped(Render("still", 5, RollingShutters()), {}).Calibrate();
  EXPECT_FALSE(result.is_accepted);
  for (const CalibratedParameter& parameter : result.parameters) {
    EXPECT_NE(parameter.status, Status::kDetermined);
  }
  for (const CalibrationIndex k : {kColorReadout, kDepthReadout, kDepthTime}) {
    EXPECT_EQ(Of(result, k).status, Status::kUndetermined);
    EXPECT_EQ(Of(result, k).found, 0.0);
  }
}

TEST(CalibrationTest, ASolutionThatIsWorseThanTheMapIsAFailure) {
  CalibrationResult result;
  result.held_out_pairs = 10;
  result.cost_of_map = 1.0;
  result.cost_before = 3.0;
  result.cost_after = 2.0;
  result.gain_sigmas = 5.0;
  EXPECT_NE(WhyNoBetter({}, {}, result).find("the solution fails"),
            std::string::npos);
}

TEST(CalibrationTest, ALensThatTurnsOverInTheCornersIsRefused) {
  CalibrationResult result;
  result.found.camera.k1 = -0.9;
  const std::string why = ImplausibilityReason({}, result);
  EXPECT_NE(why.find("not invertible at the image border"), std::string::npos)
      << why;
  // A camera that had this fault before is not refused.
  EXPECT_EQ(ImplausibilityReason(result.found, result), "");
  result.found.camera.k1 = -0.2;
  EXPECT_EQ(ImplausibilityReason({}, result), "");
}

TEST(CalibrationTest, OnlyAPrincipalPointThatLeavesTheCentreIsRefused) {
  CalibrationResult result;
  result.found.camera.cx = 390.0;
  const std::string why = ImplausibilityReason({}, result);
  EXPECT_NE(why.find("principal point (390, 240) is too far"),
            std::string::npos)
      << why;
  RgbdCamera cropped;
  cropped.camera.cx = 388.0;
  EXPECT_EQ(ImplausibilityReason(cropped, result), "");
}

TEST(CalibrationTest, HalvesOfOneCameraAgree) {
  // Odometry corrects the wrong depth offset only approximately.
  RgbdCamera wrong = Wrong();
  wrong.depth_shutter.offset = 0.0;
  const CalibrationResult result = Mapped(Handheld(), wrong).Calibrate();
  EXPECT_TRUE(result.is_accepted) << result.reason;
  ASSERT_FALSE(result.halves.empty());
  EXPECT_EQ(WhyUnchecked({}, result), "");
  for (const HalvesOfParameter& half : result.halves) {
    EXPECT_EQ(Of(result, static_cast<CalibrationIndex>(half.part)).status,
              Status::kDetermined);
    EXPECT_GT(half.sigma, 0.0);
  }
}

TEST(CalibrationTest, HalvesWidenErrorBars) {
  EXPECT_EQ(SpreadOfHalves({}), 0.0);
  EXPECT_DOUBLE_EQ(
      SpreadOfHalves({{kCx, 320.0, 321.0, 1.0}, {kFx, 520.0, 534.0, 2.0}}),
      5.0);
}

TEST(CalibrationTest, HalvesThatContradictEachOtherAreNamed) {
  CalibrationResult result;
  result.halves = {{kCx, 320.0, 321.0, 1.0}, {kFx, 520.0, 530.0, 2.0}};
  const std::string why = WhyUnchecked({}, result);
  EXPECT_NE(why.find("disagree: fx differs by 10 px (5 standard deviations)"),
            std::string::npos)
      << why;
  CalibrationSettings lenient;
  lenient.max_halves_sigmas = 6.0;
  EXPECT_EQ(WhyUnchecked(lenient, result), "");
}

TEST(CalibrationTest, WhatChangesACameraIsFoundBetweenBoth) {
  RgbdCamera first = Wrong();
  first.depth_correction.depth_from_color =
      Rigid3d::FromRotationVector({0.0, 0.0, 0.01}, {0.01, 0.0, -0.02});
  CalibrationVector theta;
  theta << 520.0, 521.0, 318.0, 241.0, 0.01, -0.02, 0.03, 0.04, 0.001, -0.002,
      0.003, 0.004, 0.025, -0.01, 0.005, -0.006, 0.007, 0.008, -0.009, 0.010,
      1.02;
  EXPECT_TRUE(ThetaBetween(first, ApplyCalibration(first, theta))
                  .isApprox(theta, 1e-9));
}

TEST(CalibrationTest, AKnownLengthHasToMakeSense) {
  const Mapped at_rest(Render("still", 5), RgbdCamera());
  const auto expect = [&](const char* text, const char* part) {
    CalibrationSettings settings;
    settings.known_length = text;
    ExpectInputError([&] { at_rest.Calibrate(settings); },
                     {"known_length: ", part});
  };
  for (const char* text :
       {"1000,1000.1", "a,b,c", "1000,1000.1,-1", "1000,1000.1,1,1"}) {
    expect(text, "must be T0,T1,METRES");
  }
  expect("1000,5000,1", "no frame was tracked at 5000");
  expect("1000,1000.1,1", "hardly moved");
}

TEST(CalibrationTest, SaysThatTheCameraMayHaveBeenLost) {
  const Mapped dark({}, RgbdCamera());
  EXPECT_EQ(dark.Calibrate().reason,
            "the camera hardly moved or was lost: only 0 landmark views in 0 "
            "keyframes of 0 tracked frames; rgbd_odometry says which frames "
            "are lost");
}

TEST(CalibrationTest, AKnownLengthDoesNotSpanLostFrames) {
  CalibrationData data;
  data.timestamps = {0.0, 1.0};
  Trajectory path;
  for (int i = 0; i <= 15; ++i) path.push_back({0.1 * i, Rigid3d()});
  AddKnownDistances(path, "0.0,1.5,1.0", {}, &data);
  EXPECT_EQ(data.views.distances.size(), 1u);
  path.erase(path.begin() + 12, path.begin() + 14);
  ExpectInputError([&] { AddKnownDistances(path, "0.0,1.5,1.0", {}, &data); },
                   {"known_length: frames near 1.5 s were lost"});
}

// Fewer frames would make velocities, and with them readouts, too small.
TEST(CalibrationTest, UsesAllFramesOfACameraWith30PerSecond) {
  const TempFolder folder;
  SyntheticOptions options;
  options.frames = 7;
  options.camera.camera = {64, 48, 60, 60, 31.5, 23.5};
  SyntheticDataset recording(options);
  WriteTumSequence(&recording, folder / "sequence");
  const auto count = [&folder](const CalibrationSettings& settings) {
    SequenceSettings sequence;
    sequence.dataset = folder / "sequence";
    int used = 0;
    CalibrateRecording(sequence, CalibrationOdometry(), CalibrationSlam(),
                       settings, /*threads=*/1,
                       [&used](int, int, int all) { used = all; });
    return used;
  };
  EXPECT_EQ(count({}), options.frames);
  CalibrationSettings slow;
  slow.max_rate = 15.0;
  EXPECT_EQ(count(slow), (options.frames + 1) / 2);
}

}  // namespace
}  // namespace rgbd_pose
