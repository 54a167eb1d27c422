#include "apps/pipeline/odometry_run.h"

#include <cstdio>
#include <optional>

#include "core/initial_guess/initial_guess.h"
#include "core/util/named_values.h"
#include "costs/cost_factory.h"
#include "frontend/features/frontend.h"
#include "frontend/sources/frame_stream.h"

namespace rgbd_pose {
namespace {

constexpr Named<LostPolicy> kLostPolicies[] = {
    {"stop", LostPolicy::kStop},
    {"hold", LostPolicy::kHold},
    {"predict", LostPolicy::kPredict},
    {"new_segment", LostPolicy::kNewSegment},
};

OdometryOptions MakeOdometryOptions(const OdometrySettings& settings) {
  OdometryOptions options;
  options.predict_velocity = settings.initial_guess == "velocity";
  options.initial_guess = FindInitialGuess(settings.initial_guess);
  if (options.initial_guess == nullptr && !options.predict_velocity &&
      settings.initial_guess != "last") {
    throw UnknownName("initial guess", settings.initial_guess,
                      OdometryGuessNames());
  }
  options.on_lost = ValueOf(kLostPolicies, "policy", settings.on_lost);
  return options;
}

}  // namespace

std::vector<std::string> OdometryGuessNames() {
  std::vector<std::string> names = {"last", "velocity"};
  for (const InitialGuess& row : InitialGuesses()) names.emplace_back(row.name);
  return names;
}

std::vector<std::string> LostPolicyNames() { return NamesOf(kLostPolicies); }

Odometry MakeOdometry(const OdometrySettings& settings, const Camera& camera) {
  FrontendOptions frontend;
  frontend.camera = camera;
  frontend.depth_noise = DepthNoiseByName(settings.depth_noise);
  frontend.max_features = settings.max_features;
  return Odometry(MakeOdometryOptions(settings), camera,
                  MakeFrontend(settings.frontend, frontend),
                  Estimator(MakeEstimatorOptions(settings),
                            MakeRobustCosts(settings.cost, settings.loss)));
}

std::vector<TrackedFrame> RunOdometry(FrameSource* source, Odometry* odometry,
                                      const RunOptions& options) {
  FrameStream stream(
      source,
      [odometry](const Frame& frame) { return odometry->Prepare(frame); },
      options.threads);
  std::vector<TrackedFrame> frames;
  while (const std::optional<StreamedFrame> next = stream.Next()) {
    std::optional<Rigid3d> guess;
    if (options.motion_guess != nullptr && !frames.empty()) {
      guess = options.motion_guess->CurFromPrev(frames.back().timestamp,
                                                next->frame->timestamp);
    }
    frames.push_back(
        odometry->Track(*next->frame, guess.has_value() ? &*guess : nullptr));
    frames.back().decode_ms = next->decode_ms;
    if (options.on_frame) options.on_frame(*next->frame, frames.back());
  }
  return frames;
}

std::vector<double> ReadAllFrames(
    FrameSource* source, int threads,
    const std::function<void(int done)>& progress) {
  FrameStream stream(source, nullptr, threads);
  std::vector<double> decode_ms;
  while (const std::optional<StreamedFrame> next = stream.Next()) {
    decode_ms.push_back(next->decode_ms);
    progress(static_cast<int>(decode_ms.size()));
  }
  return decode_ms;
}

Trajectory TrackedTrajectory(const std::vector<TrackedFrame>& frames) {
  Trajectory trajectory;
  for (const TrackedFrame& frame : frames) {
    if (frame.status == TrackingStatus::kLost) continue;
    trajectory.push_back({frame.timestamp, frame.world_from_cam});
  }
  return trajectory;
}

std::string FormatFramesCsv(const std::vector<TrackedFrame>& frames) {
  std::string text =
      "timestamp,status,reason,segment,reference,is_reference,relocalised,"
      "matches,inliers,iterations,sigma,decode_ms,track_ms,match_ms,solve_ms,"
      "reference_ms,relocalise_ms\n";
  char row[512];
  for (const TrackedFrame& frame : frames) {
    // Reasons are our own words and hold no quotes.
    std::snprintf(
        row, sizeof(row),
        "%.6f,%s,\"%s\",%d,%d,%d,%d,%d,%d,%d,%.4f,%.3f,%.3f,%.3f,%.3f,%.3f,"
        "%.3f\n",
        frame.timestamp, ToString(frame.status), frame.reason.c_str(),
        frame.segment, frame.reference, frame.is_reference, frame.relocalised,
        frame.matches, frame.inliers, frame.iterations, frame.sigma,
        frame.decode_ms, frame.track_ms, frame.match_ms, frame.solve_ms,
        frame.reference_ms, frame.relocalise_ms);
    text += row;
  }
  return text;
}

}  // namespace rgbd_pose
