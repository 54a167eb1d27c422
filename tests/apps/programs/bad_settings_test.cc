// Wrong cameras and flags as input of rgbd_odometry. What else may be wrong in
// a camera file or a file of flags is tested where these are read.

#include "tests/support/bad_input.h"

namespace rgbd_pose {
namespace {

using Seq = SpoiledSequence;

// Changes the sequence's camera file, which has ORB-SLAM's layout.
auto Camera(const std::string& from, const std::string& to) {
  return [=](const Seq& seq) { seq.Replace("camera.yaml", from, to); };
}

TEST_F(BadInputTest, Cameras) {
  const std::string kFile = "{seq}/camera.yaml";
  ExpectEach(Odometry(),
             {
                 {"a word", Camera("fx: 262", "fx: wide"), "", 2,
                  kFile + ":2: 'wide' is not a finite number for Camera.fx"},
                 {"a tab for an indent", Camera("%YAML:1.0\n", "a:\n\tb: 1\n"),
                  "", 2, "not valid YAML"},
                 {"the sequence's own", nullptr, "--camera=", 0, ""},
                 {"none", [](const Seq& s) { s.Remove("camera.yaml"); },
                  "--camera=", 2, "{seq}: contains no camera calibration"},
             });
  ExpectRefused(
      Odometry(),
      {
          {"--camera=kinnect",
           "camera 'kinnect' is neither a file nor one of the presets: "
           "tum_fr1"},
          {"--camera={seq}", "{seq}: is a folder"},
          {"--depth_camera=cam1", kFile + ": has no depth camera 'cam1'"},
          {"--camera= --depth_camera=cam1",
           "depth_camera 'cam1': needs a Kalibr file with this camera as "
           "camera (--camera), even if it is the recording's own"},
      });
}

TEST_F(BadInputTest, Flags) {
  const std::string kThreads = "--threads must be 0 (one per core) to 256";
  const std::string kFeatures = "max_features must be 3 to 1000000";
  const std::string kDepthScale = "depth_scale must be positive";
  const std::string kDepths =
      "depth limits must satisfy 0 < min_depth < max_depth <= 1000 m";
  const std::string kShare =
      "max_damaged must be 0 to 1, a share of the frames";
  ExpectNeeded(Odometry(), {"--dataset"});
  ExpectRefused(
      Odometry(),
      {
          {"--los=tukey", "unknown flag --los; did you mean --loss?"},
          {"tukey", "'tukey' is not a flag"},
          {"--flagfile={seq}/none", "{seq}/none: cannot be opened"},
          {"--threads=-1", kThreads},
          {"--threads=257", kThreads},
          {"--cost=magic", "unknown cost 'magic'; available"},
          {"--cost=reprojection+", "unknown cost ''"},
          {"--loss=tuckey", "unknown loss 'tuckey'; available"},
          {"'--loss=tukey(-1)'",
           "loss 'tukey(-1)': the width must be a number from"},
          {"--loss=tukey,huber", "'tukey,huber' names 2 losses for 1 costs"},
          {"--frontend=magic",
           "unknown frontend 'magic'; available: klt, patch"},
          // Also where it is not used.
          {"--tracker=direct --frontend=magic", "unknown frontend 'magic'"},
          {"--scale=iqr", "unknown scale 'iqr'; available"},
          {"--robust_schedule=slow",
           "unknown robust schedule 'slow'; available: gnc"},
          {"--initial_guess=wild",
           "unknown initial guess 'wild'; available: last"},
          {"--on_lost=cry", "unknown policy 'cry'"},
          {"--assembly=line", "unknown assembly"},
          {"--depth_noise=white", "unknown depth noise"},
          {"--max_features=2", kFeatures},
          {"--max_features=2000000000", kFeatures},
          {"--min_inliers=2", "min_inliers must be at least 3"},
          {"--gnc_factor=1", "gnc_factor must be at least 1.01"},
          {"--depth_scale=-1", kDepthScale},
          {"--depth_scale=nan", kDepthScale},
          {"--depth_scale=inf", kDepthScale},
          {"--voxel=0", "--voxel or --max_depth: the voxel size must"},
          {"--voxel=2", "--voxel or --max_depth: "},
          {"--voxel=nan", "--voxel or --max_depth: "},
          {"--max_depth=inf", kDepths},
          {"--max_depth=0.1", kDepths},
          {"--max_damaged=-1", kShare},
          {"--max_damaged=50", kShare},
          {"--max_damaged=nan", kShare},
          {"--debug_images=20-10",
           "--debug_images=20-10: '20-10' is not a frame number"},
          {"--debug_images=some", "'some' is not a frame number"},
          {"--source=lidar", "unknown source 'lidar'"},
          {"--source=7scenes",
           "{seq}: has no colour images such as frame-123.color.png"},
          {"--frames=all", "frames 'all': is not a valid range"},
          {"--frames=100-", "none of them in this range"},
      });
}

}  // namespace
}  // namespace rgbd_pose
