#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/compare/compare_sequence.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"

namespace rgbd_pose {

// A frame of a path. What is not known is empty.
struct ComparedPose {
  double timestamp = 0.0;  // s
  std::optional<Rigid3d> world_from_cam;
  // From the truth of the same moment.
  std::optional<double> distance;  // m
  std::optional<double> angle;     // rad
  // Of the motion over the second that starts here.
  std::optional<double> rpe_translation;  // m
  std::optional<double> rpe_rotation;     // rad
};

struct ComparedPath {
  std::string name;  // a loss, or kTruthName
  std::vector<ComparedPose> poses;
};

constexpr char kTruthName[] = "truth";

// The paths of all runs in one world, one pose for every frame of the sequence.
// With a ground truth that is its world, each path's first paired pose is laid
// on the truth's, and the first path is the truth. Without one it is the first
// camera.
std::vector<ComparedPath> ComparePaths(const std::vector<LossRun>& runs,
                                       const std::optional<Trajectory>& truth);

// paths.csv: a row for each frame of each path, each row beginning with `name`
// (of the sequence); lengths in metres, angles in degrees.
std::string ComparedPathsCsvRows(const std::string& name,
                                 const std::vector<ComparedPath>& paths);
extern const char kComparedPathsCsvHeader[];

// Top views X-Y and X-Z of the paths, as in the thesis' Figures 4.8 and 4.9,
// and where there is a truth how far off they are over time. SVG.
std::string PathFigure(const std::string& title,
                       const std::vector<ComparedPath>& paths);

}  // namespace rgbd_pose
