#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A camera pose and its time.
struct StampedPose {
  double timestamp = 0.0;  // s
  Rigid3d world_from_cam;  // m
};

// Poses with strictly increasing timestamps.
using Trajectory = std::vector<StampedPose>;

// A trajectory, interpolated between its poses: positions linearly,
// orientations spherically, but not across gaps of `max_gap` (s) or more: a
// hand can make any motion within 50 ms.
class InterpolatedPath {
 public:
  // The trajectory must outlive this object.
  explicit InterpolatedPath(const Trajectory& trajectory, double max_gap = 0.05)
      : trajectory_(trajectory), max_gap_(max_gap) {}

  // Returns world_from_cam at this time (s); nothing in a gap, before the first
  // pose or after the last.
  std::optional<Rigid3d> At(double time) const;

 private:
  const Trajectory& trajectory_;
  const double max_gap_;
};

// Reads TUM text with one `timestamp tx ty tz qx qy qz qw` per line (world from
// camera, metres). '#' comments and empty lines are skipped; CRLF and a byte
// order mark are accepted. Quaternions within 1 % of unit length are
// normalised. If poses have the same timestamp, the first is kept, and a line
// for users is added to `remarks` unless that is null. Throws InputError
// (file:line) for anything else: missing columns, invalid numbers, NaN,
// timestamps out of order, an empty list.
Trajectory ReadTrajectory(const std::string& path,
                          std::vector<std::string>* remarks = nullptr);

// Formats a trajectory as TUM text: timestamps with 6 decimals, poses with 9.
std::string FormatTrajectory(const Trajectory& trajectory);

}  // namespace rgbd_pose
