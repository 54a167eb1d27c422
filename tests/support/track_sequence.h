#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/tracking/odometry.h"
#include "frontend/tracking/tracker_factory.h"
#include "tests/support/tracker_parts.h"

namespace rgbd_pose {

// Odometry by features with a single cost.
inline Odometry MakeOdometry(const Camera& camera, const std::string& loss,
                             const OdometryOptions& options = {}) {
  TrackerParts parts = PartsFor(camera);
  parts.estimator = Estimator({}, MakeRobustCosts(kDefaultCost, loss));
  return Odometry(options, MakeTracker("features", std::move(parts)));
}

// The results of a tracked sequence.
struct TrackedSequence {
  std::vector<TrackedFrame> frames;
  Trajectory trajectory;

  int Count(TrackingStatus status) const {
    int count = 0;
    for (const TrackedFrame& frame : frames) count += frame.status == status;
    return count;
  }
};

inline TrackedSequence TrackAll(const Dataset& dataset, const std::string& loss,
                                const OdometryOptions& options = {}) {
  Odometry odometry = MakeOdometry(dataset.camera().camera, loss, options);
  TrackedSequence run;
  for (int i = 0; i < dataset.size(); ++i) {
    run.frames.push_back(odometry.Track(dataset.Read(i)));
    run.trajectory.push_back(
        {run.frames.back().timestamp, run.frames.back().world_from_cam});
  }
  return run;
}

// The room seen by a camera that moves along the given path.
inline SyntheticOptions RoomOptions(const std::string& path, int frames) {
  SyntheticOptions options;
  options.path = path;
  options.frames = frames;
  return options;
}

inline SyntheticDataset Room(const std::string& path, int frames) {
  return SyntheticDataset(RoomOptions(path, frames));
}

// The frame with a black image, in a new matrix: assigning cv::Mat::zeros would
// write into the shared one.
inline Frame Black(const Frame& frame) {
  Frame black = frame;
  black.gray = cv::Mat(frame.gray.size(), CV_8UC1, cv::Scalar(0));
  return black;
}

// The same view once more. Images of a camera differ at least in a pixel, or
// they have been sent again; here their first one is `number`.
inline Frame TakenAgain(const Frame& frame, int number) {
  Frame again = frame.Clone();
  again.gray.at<uint8_t>(0, 0) = static_cast<uint8_t>(number);
  again.depth.at<uint16_t>(0, 0) = static_cast<uint16_t>(number);
  return again;
}

}  // namespace rgbd_pose
