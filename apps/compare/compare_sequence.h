#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"
#include "frontend/slam/sequence_run.h"

namespace rgbd_pose {

// The results of a sequence with one M-estimator.
struct LossRun : RunResults {
  std::string loss;
};

// The last pose of each run relative to its first pose, in the thesis'
// parameters and as an angle and a distance, as in its Tables 4.4-4.6. With
// `returns_to_start`, the first row has the true values: [0 0 0] twice.
std::string EndPoseTable(const std::vector<LossRun>& runs,
                         bool returns_to_start);

// Errors along the path, as in the thesis' Tables 4.7 and 4.8; n/a if unknown.
std::string PathErrorTable(const std::vector<LossRun>& runs);

// tables.csv: one row per loss with `name` (of the sequence), the loss and the
// figures of both tables; unknown figures are empty cells.
std::string SequenceCsvRows(const std::string& name,
                            const std::vector<LossRun>& runs);
inline constexpr char kSequenceFigures[] =
    "alpha_deg,beta_deg,gamma_deg,cx_mm,cy_mm,cz_mm,end_deg,end_mm,ate_mm,"
    "rpe_seconds_mm,rpe_seconds_deg,tracked_share";

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

// Returns the paths of all runs in one world, with one pose for each frame.
// With a ground truth, which is then the first path, each path is aligned to it
// at its first paired pose. Without, it is the world of the first camera.
std::vector<ComparedPath> ComparePaths(const std::vector<LossRun>& runs,
                                       const std::optional<Trajectory>& truth);

// paths.csv: one row per frame of each path with `name` (of the sequence), the
// loss and these columns. Lengths are in metres, angles in degrees.
std::string ComparedPathsCsvRows(const std::string& name,
                                 const std::vector<ComparedPath>& paths);
inline constexpr char kPathColumns[] =
    "timestamp,x,y,z,qx,qy,qz,qw,distance_m,angle_deg,rpe_seconds_m,"
    "rpe_seconds_deg";

}  // namespace rgbd_pose
