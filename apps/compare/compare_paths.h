#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/compare/compare_sequence.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A frame of a path; unknown values are empty.
struct ComparedPose {
  double timestamp = 0.0;  // s
  std::optional<Rigid3d> world_from_cam;
  // Relative to the truth at the same time.
  std::optional<double> distance;  // m
  std::optional<double> angle;     // rad
  // Error of the motion over the second that starts at this frame.
  std::optional<double> rpe_translation;  // m
  std::optional<double> rpe_rotation;     // rad
};

struct ComparedPath {
  std::string name;  // a loss or kTruthName
  std::vector<ComparedPose> poses;
};

constexpr char kTruthName[] = "truth";

// Returns the paths of all runs in one world, with one pose for each frame of
// the sequence. With a ground truth, this is the world of the truth, and each
// path is aligned to it at its first paired pose; the first returned path is
// the truth. Without a ground truth, it is the world of the first camera.
std::vector<ComparedPath> ComparePaths(const std::vector<LossRun>& runs,
                                       const std::optional<Trajectory>& truth);

// paths.csv: one row per frame of each path. Each row starts with `name` (of
// the sequence). Lengths are in metres, angles in degrees.
std::string ComparedPathsCsvRows(const std::string& name,
                                 const std::vector<ComparedPath>& paths);
extern const char kComparedPathsCsvHeader[];

// SVG with top views X-Y and X-Z of the paths, as in the thesis' Figures 4.8
// and 4.9, and, with a truth, the errors over time.
std::string PathFigure(const std::string& title,
                       const std::vector<ComparedPath>& paths);

}  // namespace rgbd_pose
