// Wrong cameras and flags as input of rgbd_odometry.

#include "tests/support/bad_input.h"

namespace rgbd_pose {
namespace {

using Seq = SpoiledSequence;

constexpr char kRos[] =
    "image_width: 320\nimage_height: 240\n"
    "camera_matrix: {data: [262, 0, 160, 0, 262, 120, 0, 0, 1]}\n"
    "distortion_coefficients: {data: [0, 0, 0, 0, 0]}\n";
constexpr char kKalibr[] =
    "cam0:\n  camera_model: pinhole\n  intrinsics: [262, 262, 160, 120]\n"
    "  distortion_model: radtan\n  distortion_coeffs: [0, 0, 0, 0]\n"
    "  resolution: [320, 240]\n";

// Changes a camera file: the sequence's (in ORB-SLAM's layout), or `base`.
auto Camera(const std::string& from, const std::string& to,
            const std::string& base = "") {
  return [=](const Seq& seq) {
    if (!base.empty()) seq.Write("camera.yaml", base);
    seq.Replace("camera.yaml", from, to);
  };
}

TEST_F(BadInputTest, Cameras) {
  const std::string kFile = "{seq}/camera.yaml";
  ExpectEach(
      Odometry(),
      {
          {"neither file nor preset", nullptr, "--camera=kinnect", 2,
           "camera 'kinnect' is neither a file nor one of the presets: "
           "tum_fr1"},
          {"a folder", nullptr, "--camera={seq}", 2, "{seq}: is a folder"},
          {"empty", [](const Seq& s) { s.Write("camera.yaml", ""); }, "", 2,
           kFile + ": contains no camera; supported layouts are ORB-SLAM"},
          {"no focal length", Camera("Camera.fx: 262\n", ""), "", 2,
           "Camera.fx is missing"},
          {"negative focal length", Camera("fx: 262", "fx: -262"), "", 2,
           kFile + ": fx and fy must be positive"},
          {"zero focal length", Camera("fx: 262", "fx: 0"), "", 2,
           kFile + ": fx and fy must be positive"},
          {"nan focal length", Camera("fx: 262", "fx: .nan"), "", 2,
           kFile + ":2: '.nan' is not a finite number for Camera.fx"},
          {"infinite focal length", Camera("fx: 262", "fx: .inf"), "", 2,
           kFile + ":2: '.inf' is not a finite number for Camera.fx"},
          {"a word", Camera("fx: 262", "fx: wide"), "", 2,
           kFile + ":2: 'wide' is not a finite number for Camera.fx"},
          {"a list for a number", Camera("fx: 262", "fx: [262]"), "", 2,
           kFile + ":2: '' is not a finite number for Camera.fx"},
          {"focal length not in pixels", Camera("fx: 262", "fx: 0.8"), "", 2,
           kFile + ": fx and fy must be in pixels"},
          {"centre outside", Camera("cx: 160", "cx: 400"), "", 2,
           kFile + ": the principal point must lie inside the image"},
          {"no whole width", Camera("width: 320", "width: 320.5"), "", 2,
           "Camera.width must be a positive whole number of pixels"},
          {"huge width", Camera("width: 320", "width: 1e9"), "", 2,
           "Camera.width must be a positive whole number of pixels"},
          {"depth scale upside down",
           Camera("DepthMapFactor: 5000", "DepthMapFactor: 0.0002"), "", 2,
           "DepthMapFactor must be raw depth units per metre"},
          {"another type", Camera("%YAML:1.0", "Camera.type: Unified"), "", 2,
           kFile + ":1: Camera.type 'Unified' is not supported"},
          {"broken YAML", Camera("Camera.fx: 262", "Camera.fx: [262"), "", 2,
           "not valid YAML"},
          {"a tab for an indent", Camera("%YAML:1.0\n", "a:\n\tb: 1\n"), "", 2,
           "not valid YAML"},
          {"ROS: fisheye",
           Camera("image_height", "distortion_model: equidistant\nimage_height",
                  kRos),
           "", 2, "distortion_coefficients.data needs a list of 4 numbers"},
          {"ROS: matrix too short", Camera(", 0, 0, 1]", "]", kRos), "", 2,
           kFile + ":3: camera_matrix.data needs a list of 9 numbers"},
          {"ROS: skew", Camera("262, 0, 160", "262, 3, 160", kRos), "", 2,
           "camera_matrix.data must read [fx 0 cx 0 fy cy 0 0 1]"},
          {"ROS: no matrix",
           Camera("camera_matrix: {data", "camera_matrix: [", kRos), "", 2,
           "not valid YAML"},
          {"ROS: good", Camera("width", "width", kRos), "", 0, ""},
          {"Kalibr: field of view", Camera("radtan", "fov", kKalibr), "", 2,
           kFile + ":4: cam0.distortion_model 'fov' is not supported"},
          {"Kalibr: another model", Camera("pinhole", "omni", kKalibr), "", 2,
           "cam0.camera_model 'omni' is not supported, only: pinhole"},
          {"Kalibr: three intrinsics", Camera("262, 262", "262", kKalibr), "",
           2, kFile + ":3: cam0.intrinsics needs a list of 4 numbers"},
          {"Kalibr: no resolution",
           Camera("  resolution: [320, 240]\n", "", kKalibr), "", 2,
           "cam0.resolution is missing"},
          {"Kalibr: CRLF",
           [](const Seq& s) {
             std::string text = "\xEF\xBB\xBF";
             for (const char* c = kKalibr; *c != '\0'; ++c) {
               text += *c == '\n' ? std::string("\r\n") : std::string(1, *c);
             }
             s.Write("camera.yaml", text);
           },
           "", 0, ""},
      });
}

TEST_F(BadInputTest, Flags) {
  ExpectEach(
      Odometry(),
      {
          {"unknown", nullptr, "--los=tukey", 2,
           "unknown flag --los; did you mean --loss?"},
          {"no flag", nullptr, "tukey", 2, "'tukey' is not a flag"},
          {"after two dashes", nullptr, "-- tukey", 2, "'--' is not a flag"},
          {"of gflags", nullptr, "--fromenv=loss", 2, "unknown flag --fromenv"},
          {"that lists every library's", nullptr, "--helpxml", 2,
           "unknown flag --helpxml"},
          {"no value", nullptr, "--loss", 2, "--loss needs a value"},
          {"no number", nullptr, "--threads=many", 2,
           "'many' is not a valid int32 for --threads"},
          {"a number that is too large", nullptr, "--threads=99999999999", 2,
           "'99999999999' is not a valid int32 for --threads"},
          {"no switch", nullptr, "--report=perhaps", 2,
           "'perhaps' is not a valid bool for --report"},
          {"negative threads", nullptr, "--threads=-1", 2,
           "--threads must be 0 (one per core) to 256"},
          {"too many threads", nullptr, "--threads=257", 2, "--threads must"},
          {"cost", nullptr, "--cost=magic", 2,
           "unknown cost 'magic'; available"},
          {"a cost that is not there", nullptr, "--cost=reprojection+", 2,
           "unknown cost ''"},
          {"loss", nullptr, "--loss=tuckey", 2,
           "unknown loss 'tuckey'; available"},
          {"a width", nullptr, "'--loss=tukey(-1)'", 2,
           "loss 'tukey(-1)': the width must be a number from"},
          {"two losses for one cost", nullptr, "--loss=tukey,huber", 2,
           "'tukey,huber' names 2 losses for 1 costs"},
          {"frontend that is not used", nullptr,
           "--tracker=direct --frontend=magic", 2, "unknown frontend 'magic'"},
          {"frontend", nullptr, "--frontend=magic", 2,
           "unknown frontend 'magic'; available: klt, patch"},
          {"scale", nullptr, "--scale=iqr", 2,
           "unknown scale 'iqr'; available"},
          {"schedule", nullptr, "--robust_schedule=slow", 2,
           "unknown robust schedule 'slow'; available: gnc"},
          {"guess", nullptr, "--initial_guess=wild", 2,
           "unknown initial guess 'wild'; available: last"},
          {"policy", nullptr, "--on_lost=cry", 2, "unknown policy 'cry'"},
          {"assembly", nullptr, "--assembly=line", 2, "unknown assembly"},
          {"noise", nullptr, "--depth_noise=white", 2, "unknown depth noise"},
          {"too few features", nullptr, "--max_features=2", 2,
           "max_features must be 3 to 1000000"},
          {"too few inliers", nullptr, "--min_inliers=2", 2,
           "min_inliers must be at least 3"},
          {"a graduation that stands still", nullptr, "--gnc_factor=1", 2,
           "gnc_factor must be at least 1.01"},
          {"no whole number", nullptr, "--max_iterations=1.5", 2,
           "'1.5' is not a valid int32 for --max_iterations"},
          {"far too many features", nullptr, "--max_features=2000000000", 2,
           "max_features must be 3 to 1000000"},
          {"negative depth scale", nullptr, "--depth_scale=-1", 2,
           "depth_scale must be positive"},
          {"a depth scale that is no number", nullptr, "--depth_scale=nan", 2,
           "depth_scale must be positive"},
          {"infinite depth scale", nullptr, "--depth_scale=inf", 2,
           "depth_scale must be positive"},
          {"no cubes", nullptr, "--voxel=0", 2,
           "--voxel or --max_depth: the voxel size must"},
          {"cubes as large as rooms", nullptr, "--voxel=2", 2,
           "--voxel or --max_depth: "},
          {"cubes that are no number", nullptr, "--voxel=nan", 2,
           "--voxel or --max_depth: "},
          {"depths without end", nullptr, "--max_depth=inf", 2,
           "depth limits must satisfy 0 < min_depth < max_depth <= 1000 m"},
          {"depth limits the wrong way round", nullptr, "--max_depth=0.1", 2,
           "depth limits must satisfy 0 < min_depth < max_depth <= 1000 m"},
          {"frames backwards", nullptr, "--debug_images=20-10", 2,
           "--debug_images=20-10: '20-10' is not a frame number"},
          {"frames in words", nullptr, "--debug_images=some", 2,
           "'some' is not a frame number"},
          {"no dataset", nullptr, "--dataset=", 1, "--dataset is needed"},
          {"its own camera", nullptr, "--camera=", 0, ""},
          {"no camera", [](const Seq& s) { s.Remove("camera.yaml"); },
           "--camera=", 2, "{seq}: contains no camera calibration"},
          {"no depth camera", nullptr, "--depth_camera=cam1", 2,
           "{seq}/camera.yaml: has no depth camera 'cam1'"},
          {"a depth camera of nothing", nullptr,
           "--camera= --depth_camera=cam1", 2,
           "depth_camera 'cam1': needs a Kalibr file"},
          {"unknown source", nullptr, "--source=lidar", 2,
           "unknown source 'lidar'"},
          {"another source", nullptr, "--source=7scenes", 2,
           "{seq}: has no colour images such as frame-123.color.png"},
          {"frames that are none", nullptr, "--frames=all", 2,
           "frames 'all': is not a valid range"},
          {"frames that are not there", nullptr, "--frames=100-", 2,
           "none of them in this range"},
      });
}

TEST_F(BadInputTest, FlagFiles) {
  const auto file = [](const std::string& content) {
    return [=](const Seq& seq) { seq.Write("run.flags", content); };
  };
  ExpectEach(
      Odometry() + "--flagfile={seq}/run.flags ",
      {
          {"missing", nullptr, "", 2, "{seq}/run.flags: cannot be opened"},
          {"unknown flag", file("# a\n--los=tukey\n"), "", 2,
           "{seq}/run.flags:2: unknown flag --los"},
          {"no dashes", file("loss=tukey\n"), "", 2,
           "{seq}/run.flags:1: 'loss=tukey' is not a flag"},
          {"no number", file("  --threads=x\n"), "", 2,
           "{seq}/run.flags:1: 'x' is not a valid int32 for --threads"},
          {"zero bytes", file(std::string("--flagfile\0=x\n", 14)), "", 2,
           "{seq}/run.flags:1: '--flagfile =x' is not a flag"},
          {"help", file("--help\n"), "", 2, "unknown flag --help"},
          {"names itself",
           [](const Seq& s) {
             s.Write("run.flags", "--flagfile=" + s / "run.flags" + "\n");
           },
           "", 2, "flag files include each other in a loop"},
          {"CRLF and a byte order mark",
           file("\xEF\xBB\xBF# a\r\n\r\n--loss=huber \r\n--noreport\r\n"), "",
           0, ""},
      });
}

}  // namespace
}  // namespace rgbd_pose
