#include "frontend/files/camera_file.h"

#include <gtest/gtest.h>

#include "core/util/input_error.h"
#include "tests/support/camera_file_samples.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

void ExpectCamera(const Camera& camera, const Camera& expected) {
  EXPECT_EQ(camera.width, expected.width);
  EXPECT_EQ(camera.height, expected.height);
  EXPECT_EQ(camera.lens_model, expected.lens_model);
  for (const auto& [name, value] : kCameraParameters) {
    EXPECT_EQ(camera.*value, expected.*value) << name;
  }
}

const Camera kOrbSlam2Camera = {640,    480,     517.3,   516.5,  318.6, 255.3,
                                0.2624, -0.9531, -0.0054, 0.0026, 1.1633};
const Camera kOrbSlam3Camera = {640, 480, 535.4, 539.2, 320.1, 247.6,
                                0.1, 0.2, 0.3,   0.4,   0.0};
const Camera kRosCamera = {320,  240,  270.5, 271.5, 160.25, 120.75,
                           0.01, 0.02, 0.03,  0.04,  0.05};
const Camera kKalibrCamera = {848,  480,  600.5, 601.5, 424.25, 240.75,
                              0.01, 0.02, 0.03,  0.04,  0.0};

std::string WithCrLf(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\n') result += '\r';
    result += c;
  }
  return result;
}

Camera WithLens(Camera camera, LensModel model,
                const std::vector<double>& coefficients) {
  EXPECT_TRUE(camera.SetDistortion(model, coefficients));
  return camera;
}

TEST(CameraFileTest, EveryLayoutIsRead) {
  const std::vector<double> four = {0.01, 0.02, 0.03, 0.04};
  const std::string ros_of_four = Replace(kRos, ", 0.05]", "]");
  const struct {
    std::string text;
    Camera camera;
    double depth_scale = 5000.0;
  } kCases[] = {
      {kOrbSlam2, kOrbSlam2Camera, 5208.0},
      {"\xEF\xBB\xBF" + WithCrLf(kOrbSlam2), kOrbSlam2Camera, 5208.0},
      {kOrbSlam3, kOrbSlam3Camera, 1000.0},
      {kRos, kRosCamera},
      {ros_of_four, WithLens(kRosCamera, LensModel::kRational, four)},
      {Replace(Replace(kRos, "plumb_bob", "rational_polynomial"), ", 0.05]",
               ", 0.05, 0.06, 0.07, 0.08]"),
       WithLens(kRosCamera, LensModel::kRational,
                {0.01, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07, 0.08})},
      {Replace(ros_of_four, "plumb_bob", "equidistant"),
       WithLens(kRosCamera, LensModel::kEquidistant, four)},
      {Replace(kKalibr, "radtan", "equidistant"),
       WithLens(kKalibrCamera, LensModel::kEquidistant, four)},
      {"Camera.type: \"KannalaBrandt8\"\n"
       "Camera1.fx: 285\nCamera1.fy: 286\n"
       "Camera1.cx: 319\nCamera1.cy: 240\n"
       "Camera1.k1: 0.1\nCamera1.k2: 0.2\nCamera1.k3: 0.3\nCamera1.k4: 0.4\n"
       "Camera.width: 640\nCamera.height: 480\n",
       WithLens({640, 480, 285, 286, 319, 240}, LensModel::kEquidistant,
                {0.1, 0.2, 0.3, 0.4})},
      {std::string(kRos) + "DepthMapFactor: 1000\n", kRosCamera, 1000.0},
      {R"({"width": 640, "height": 480, "depth_scale": 1000,
           "intrinsic_matrix": [525, 0, 0, 0, 526, 0, 319, 240, 1]})",
       {640, 480, 525, 526, 319, 240},
       1000.0},
      {R"({"width": 640, "height": 480,
           "intrinsic_matrix": [525, 0, 319, 0, 526, 240, 0, 0, 1]})",
       {640, 480, 525, 526, 319, 240}},
      {kKalibr, kKalibrCamera}};
  const TempFolder folder;
  for (const auto& good : kCases) {
    SCOPED_TRACE(good.text);
    const CameraSetup setup =
        ReadCameraFile(folder.Write("camera.yaml", good.text), "cam0");
    ExpectCamera(setup.camera, good.camera);
    EXPECT_EQ(RegisteredCamera(setup).depth_scale, good.depth_scale);
    EXPECT_FALSE(setup.depth_camera.has_value());
  }
}

// Files in which one text is replaced by another.
TEST(CameraFileTest, ABadOneIsRefusedInOneLineThatSaysWhere) {
  const std::string kNoCamera = ": contains no camera; supported layouts are ";
  const std::string kWidth =
      ":13: Camera.width must be a positive whole number of pixels";
  const struct {
    std::string text, from, to, message;  // including line and key
  } kCases[] = {
      {"", "", "", kNoCamera},
      {"just some words\n", "", "", kNoCamera},
      {"- 1\n- 2\n", "", "", kNoCamera},
      {"a: 1\nb: 2\n", "", "", kNoCamera},
      {"a: 1\nCamera.fx: [1, 2\n", "", "", ":3: not valid YAML"},
      {kOrbSlam2, "Camera.fy: 516.5\n", "",
       ":4: Camera.fy is missing below this line"},
      {kOrbSlam2, "Camera.width: 640\n", "",
       ":4: Camera.width is missing below this line"},
      {kOrbSlam3, "Camera1.fx: 535.4\n", "",
       ":3: Camera1.fx is missing below this line"},
      {kOrbSlam2, "516.5", ".nan",
       ":5: '.nan' is not a finite number for Camera.fy"},
      {kOrbSlam2, "516.5", "inf",
       ":5: 'inf' is not a finite number for Camera.fy"},
      {kOrbSlam2, "516.5", "516,5",
       ":5: '516,5' is not a finite number for Camera.fy"},
      {kOrbSlam2, "516.5", "[516.5]",
       ":5: '' is not a finite number for Camera.fy"},
      {kOrbSlam2, "517.3", "-480", ": fx and fy must be positive"},
      {kOrbSlam2, "318.6", "3186",
       ": the principal point must lie inside the image"},
      {kOrbSlam2, "width: 640", "width: 640.5", kWidth},
      {kOrbSlam2, "width: 640", "width: 1e300", kWidth},
      {kOrbSlam3, "PinHole", "KannalaBrandt8",
       ": an equidistant lens has k1 to k4 only"},
      {kOrbSlam3, "PinHole", "Unified",
       ":4: Camera.type 'Unified' is not supported, only: PinHole, Rectified, "
       "KannalaBrandt8"},
      {kOrbSlam2, "5208.0", "0.0002",
       ":16: DepthMapFactor must be raw depth units per metre"},
      {kOrbSlam3, "1000.0", "0",
       ":15: RGBD.DepthMapFactor must be raw depth units per metre"},
      {kOrbSlam2, "5208.0", "nan",
       ":16: 'nan' is not a finite number for DepthMapFactor"},
      {kRos, "image_height: 240\n", "",
       ":1: image_height is missing below this line"},
      {kRos, " data: [270.5", " dada: [270.5",
       ":5: camera_matrix.data is missing below this line"},
      {kRos, ", 0, 0, 1]", ", 0, 0]",
       ":7: camera_matrix.data needs a list of 9 numbers"},
      {kRos, "[270.5, 0,", "[270.5, 2,",
       ":7: camera_matrix.data must read [fx 0 cx 0 fy cy 0 0 1], row by row"},
      {"camera_matrix: 3\nimage_width: 3\nimage_height: 3\n", "", "",
       ":1: camera_matrix must be a section with keys"},
      {kRos, "plumb_bob", "omnidirectional",
       ":8: distortion_model 'omnidirectional' is not supported, only: "
       "plumb_bob, rational_polynomial, equidistant"},
      {kRos, "plumb_bob", "equidistant",
       ":12: distortion_coefficients.data needs a list of 4 numbers"},
      {kRos, ", 0.04, 0.05]", "]",
       ":12: distortion_coefficients.data needs a list of 4 or 5 numbers"},
      {kRos, "distortion_coefficients:", "coefficients:",
       ":1: distortion_coefficients is missing below this line"},
      {kKalibr, ", 240.75]", "]",
       ":5: cam0.intrinsics needs a list of 4 numbers"},
      {kKalibr, " intrinsics", " in",
       ":2: cam0.intrinsics is missing below this line"},
      {kKalibr, "601.5", "nan",
       ":5: 'nan' is not a finite number for cam0.intrinsics"},
      {kKalibr, "pinhole", "omni",
       ":2: cam0.camera_model 'omni' is not supported, only: pinhole"},
      {kKalibr, "radtan", "fov",
       ":4: cam0.distortion_model 'fov' is not supported, only: radtan, "
       "equidistant"},
      {kKalibr, "[848, 480]", "[848, -480]",
       ":6: cam0.resolution must be a positive whole number of pixels"},
  };
  const TempFolder folder;
  for (const auto& bad : kCases) {
    SCOPED_TRACE(bad.from + " -> " + bad.to);
    const std::string path =
        folder.Write("camera.yaml", Replace(bad.text, bad.from, bad.to));
    ExpectInputError([&] { ReadCameraFile(path); }, {path + bad.message});
  }
}

// For every layout, the tests of the writer read these keys.
TEST(CameraFileTest, SaysWhenRowsAreExposed) {
  const CameraSetup plain = ReadCameraText(kRos, "plain.yaml");
  EXPECT_TRUE(plain.color_shutter.IsGlobal());
  EXPECT_TRUE(plain.depth_shutter.IsGlobal());
  const CameraSetup camera =
      ReadCameraText(kRos + std::string("color_time_offset: -0.0075\n"
                                        "color_readout: 0.028\n"
                                        "depth_time_offset: 0.0125\n"
                                        "depth_readout: -0.027\n"),
                     "camera.yaml");
  EXPECT_EQ(camera.color_shutter.offset, -0.0075);
  EXPECT_EQ(camera.color_shutter.readout, 0.028);
  EXPECT_EQ(camera.depth_shutter.offset, 0.0125);
  EXPECT_EQ(camera.depth_shutter.readout, -0.027);
}

// Keys that are valid in all layouts.
TEST(CameraFileTest, TimesAndDepthErrorsAreNoLargerThanTheyCanBe) {
  const struct {
    const char* line;
    const char* problem;
  } kCases[] = {
      {"color_time_offset: 15", "color_time_offset must be at most 0.5 s"},
      {"color_readout: 5", "color_readout must be at most 0.1 s"},
      {"depth_time_offset: -15", "depth_time_offset must be at most 0.5 s"},
      {"depth_readout: -5", "depth_readout must be at most 0.1 s"},
      {"depth_readout: fast", "depth_readout"},
      {"color_readout: .nan", "color_readout"},
      {"inverse_depth_offset: 7", "inverse_depth_offset must be at most 0.5"},
      {"depth_rotation: [0.3, 0, 30]", "depth_rotation must be at most 0.5"},
      {"depth_translation: [5, 0, 0]", "depth_translation must be at most"},
      {"depth_translation: [5, 0]", "depth_translation"},
      {"depth_noise: [0, 0.0025]", "depth_noise"},
      {"depth_noise: [0, -0.0025, 0, 1]", "depth_noise (constant, quadratic"},
      {"depth_noise: [0, 2.5, 0, 1]", "depth_noise must be at most 1 m"}};
  for (const auto& bad : kCases) {
    const std::string text = std::string(kOrbSlam2) + bad.line + "\n";
    ExpectInputError([&] { ReadCameraText(text, "a.yaml"); },
                     {"a.yaml:", bad.problem});
  }
}

// A result of Kalibr: cam1 is rotated by a quarter turn around z and is 0.1 m
// along the new x away from cam0; cam2 is 0.2 m along z from cam1.
constexpr char kRig[] = R"(
cam0:
  camera_model: pinhole
  intrinsics: [600.5, 601.5, 424.25, 240.75]
  distortion_model: radtan
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  resolution: [848, 480]
cam1:
  T_cn_cnm1:
  - [0.0, 1.0, 0.0, 0.1]
  - [-1.0, 0.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  intrinsics: [400.0, 401.0, 320.0, 240.0]
  distortion_model: radtan
  distortion_coeffs: [0.1, 0.0, 0.0, 0.0]
  resolution: [640, 480]
cam2:
  T_cn_cnm1: [1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 0.2,  0, 0, 0, 1]
  camera_model: pinhole
  intrinsics: [402.0, 403.0, 320.0, 240.0]
  distortion_model: radtan
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  resolution: [640, 480]
)";

TEST(DepthCameraTest, IsReadFromARig) {
  const TempFolder folder;
  const std::string path = folder.Write("rig.yaml", kRig);
  EXPECT_FALSE(ReadCameraFile(path, "cam0").depth_camera.has_value());
  ExpectInputError([&] { ReadCameraFile(path); },
                   {"rig.yaml: has several cameras; choose",
                    "give this file as camera, with depth_camera cam1"});
  const CameraSetup setup = ReadCameraFile(path, "cam1");
  EXPECT_EQ(setup.camera.fx, 600.5);
  EXPECT_FALSE(setup.depth_scale.has_value());
  ASSERT_TRUE(setup.depth_camera.has_value());
  EXPECT_EQ(setup.depth_camera->camera.fy, 401.0);
  EXPECT_EQ(setup.depth_camera->camera.k1, 0.1);
  EXPECT_EQ(setup.depth_camera->camera.width, 640);
  // cam1_from_cam0 maps cam0's (0, 0, 1) to (0.1, 0, 1), and so on.
  const auto expect_maps = [](const CameraSetup& rig,
                              const Eigen::Vector3d& from,
                              const Eigen::Vector3d& to) {
    EXPECT_LT((rig.depth_camera->color_from_depth * from - to).norm(), 1e-12);
  };
  expect_maps(setup, {0.1, 0.0, 1.0}, {0.0, 0.0, 1.0});
  expect_maps(setup, {2.1, -1.0, 1.0}, {1.0, 2.0, 1.0});
  const CameraSetup third = ReadCameraFile(path, "cam2");
  EXPECT_EQ(third.depth_camera->camera.fx, 402.0);
  expect_maps(third, {2.1, -1.0, 1.2}, {1.0, 2.0, 1.0});
}

TEST(DepthCameraTest, RefusesWhatIsNoRig) {
  const TempFolder folder;
  const std::string path = folder.Write("rig.yaml", kRig);
  for (const char* name : {"cam3", "depth"}) {
    ExpectInputError([&] { ReadCameraFile(path, name); },
                     {path, name, "cam1 or a later one"});
  }
  const std::string bent = Replace(kRig, "- [0.0, 1.0", "- [0.0, 1.5");
  ExpectInputError([&] { ReadCameraText(bent, "bent.yaml", "cam1"); },
                   {"bent.yaml", "cam1.T_cn_cnm1", "no valid rotation"});
  const std::string cut = Replace(kRig, "  - [0.0, 0.0, 0.0, 1.0]\n", "");
  ExpectInputError([&] { ReadCameraText(cut, "cut.yaml", "cam1"); },
                   {"cut.yaml", "T_cn_cnm1", "4 lists of 4"});
  ExpectInputError([&] { ResolveCameraSetup("tum_fr1", "cam1"); },
                   {"tum_fr1", "cam1", "Kalibr"});
}

TEST(ResolveCameraTest, LeavesTheScaleOfPresetsToRecordings) {
  EXPECT_FALSE(ResolveCameraSetup("tum_fr1").depth_scale.has_value());
  EXPECT_EQ(ResolveCamera("tum_fr1").depth_scale, 5000.0);
}

TEST(ResolveCameraTest, KnowsPresetsAndFiles) {
  ExpectCamera(ResolveCamera("tum_fr1").camera,
               CameraPreset("tum_fr1")->camera);
  const TempFolder folder;
  const std::string path = folder.Write("camera.yaml", kOrbSlam3);
  ExpectCamera(ResolveCamera(path).camera, kOrbSlam3Camera);
}

TEST(ResolveCameraTest, ListsThePresetsForAnUnknownName) {
  std::vector<std::string> message_parts = CameraPresetNames();
  message_parts.push_back("'tum_fr9'");
  ExpectInputError([] { ResolveCamera("tum_fr9"); }, message_parts);
}

TEST(ResolveCameraTest, RefusesAFolder) {
  const TempFolder folder;
  EXPECT_THROW(ResolveCamera(folder.path()), InputError);
}

}  // namespace
}  // namespace rgbd_pose
