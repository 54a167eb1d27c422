
#include <gtest/gtest.h>

#include <string>

#include "core/geometry/camera.h"
#include "frontend/files/camera_file.h"
#include "tests/support/camera_file_samples.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

// Another camera of the same size; parameters missing in a layout stay 0.
RgbdCamera Changed(const RgbdCamera& first) {
  RgbdCamera camera = first;
  camera.camera.fx = 510.125;
  camera.camera.fy = 509.5;
  camera.camera.cx = 161.25;
  camera.camera.cy = 121.5;
  camera.camera.k1 = 0.0123;
  camera.camera.k2 = -0.0456;
  camera.depth_scale = 5012.25;
  camera.depth_correction.inverse_depth_offset = -0.0098;
  camera.color_shutter = {-0.0075, 0.0281};
  camera.depth_shutter = {0.0151, -0.0267};
  camera.depth_correction.depth_from_color =
      Rigid3d::FromRotationVector({0.0, 0.0052, 0.0}, {0.005, -0.001, 0.002});
  camera.depth_noise = {"", 0.0012, 0.0025, 0.4, 0.95};
  return camera;
}

void ExpectEqual(const RgbdCamera& a, const RgbdCamera& b) {
  EXPECT_EQ(a.camera.width, b.camera.width);
  EXPECT_EQ(a.camera.height, b.camera.height);
  for (const CameraParameter& parameter : kCameraParameters) {
    EXPECT_NEAR(a.camera.*parameter.value, b.camera.*parameter.value, 1e-6)
        << parameter.name;
  }
  EXPECT_NEAR(a.depth_scale, b.depth_scale, 1e-6);
  EXPECT_NEAR(a.depth_correction.inverse_depth_offset,
              b.depth_correction.inverse_depth_offset, 1e-9);
  for (const ShutterParameter& parameter : kShutterParameters) {
    EXPECT_NEAR(a.*parameter.image.*parameter.value,
                b.*parameter.image.*parameter.value, 1e-9)
        << parameter.name;
  }
  EXPECT_NEAR((a.depth_correction.depth_from_color.Inverse() *
               b.depth_correction.depth_from_color)
                  .Angle(),
              0.0, 1e-9);
  EXPECT_TRUE(a.depth_correction.depth_from_color.translation.isApprox(
      b.depth_correction.depth_from_color.translation, 1e-9));
  ASSERT_EQ(a.depth_noise.has_value(), b.depth_noise.has_value());
  if (!a.depth_noise.has_value()) return;
  EXPECT_EQ(a.depth_noise->sigma(2.0), b.depth_noise->sigma(2.0));
  EXPECT_EQ(a.depth_noise->centre, b.depth_noise->centre);
  EXPECT_EQ(a.depth_noise->mean_share, b.depth_noise->mean_share);
}

class CameraFileWriterTest : public testing::Test {
 protected:
  // Writes the camera like an earlier file, expects that it is read again, and
  // returns the path of the new file.
  std::string ExpectWritten(const RgbdCamera& camera, const std::string& like) {
    const std::string path =
        folder_.Write("new" + std::to_string(++count_) + ".yaml",
                      FormatCameraFile(camera, like));
    ExpectEqual(ResolveCamera(path), camera);
    return path;
  }

  const TempFolder folder_;

 private:
  int count_ = 0;
};

class EveryLayoutTest : public CameraFileWriterTest,
                        public testing::WithParamInterface<std::string> {};

TEST_P(EveryLayoutTest, IsWrittenAsItIsRead) {
  const std::string first = folder_.Write("camera.yaml", GetParam());
  RgbdCamera camera = Changed(ResolveCamera(first));
  const std::string second = ExpectWritten(camera, first);
  // A file that already has the keys of depth and time, and without them again.
  camera.depth_correction.inverse_depth_offset = 0.25;
  camera.color_shutter = {0.0, -0.1};
  camera.depth_shutter = {};
  camera.depth_correction.depth_from_color = Rigid3d();
  camera.depth_noise.reset();
  ExpectWritten(camera, second);
}

// A file is rewritten for another lens, in its own layout or, if that layout
// does not support the lens, in another one.
TEST_P(EveryLayoutTest, TakesEveryLens) {
  const std::string first = folder_.Write("camera.yaml", GetParam());
  RgbdCamera camera = ResolveCamera(first);
  for (const auto& [model, coefficients] :
       {std::pair(
            LensModel::kRational,
            std::vector<double>{0.5, -2.5, 1e-3, 2e-3, 1.5, 0.4, -2.3, 1}),
        std::pair(LensModel::kEquidistant,
                  std::vector<double>{-0.008, 0.045, -0.042, 0.008}),
        std::pair(LensModel::kRational,
                  std::vector<double>{0.1, -0.2, 1e-3, 2e-3, 0.0})}) {
    ASSERT_TRUE(camera.camera.SetDistortion(model, coefficients));
    const std::string next = ExpectWritten(camera, first);
    EXPECT_EQ(ResolveCamera(next).camera.lens_model, model);
    // And from there to the next lens.
    EXPECT_EQ(ResolveCamera(ExpectWritten(camera, next)).camera.Distortion(),
              coefficients);
  }
}

INSTANTIATE_TEST_SUITE_P(CameraFileWriter, EveryLayoutTest,
                         testing::Values(kOrbSlam2, kOrbSlam3, kRos, kKalibr));

// Unusual, but valid YAML.
const std::string kPlain =
    "Camera.fx: 517.3\nCamera.fy: 516.5\nCamera.cx: 318.6\nCamera.cy: 255.3\n"
    "Camera.width: 640\nCamera.height: 480\n";
constexpr char kOnOneLine[] =
    "{Camera.fx: 517.3, Camera.fy: 516.5, Camera.cx: 318.6, Camera.cy: 255.3,\n"
    " Camera.width: 640, Camera.height: 480}\n";
constexpr char kQuoted[] =
    "%YAML:1.0\n"
    "of: \"its maker said\n"
    "Camera.fx: 1\n"
    "Camera.k1: 2\"\n"
    "Camera.fx: 517.3\n"
    "Camera.fy: 516.5 # as measured\n"
    "Camera.cx: 318.6\n"
    "Camera.cy: 255.3\n"
    "Camera.width: 640\n"
    "Camera.height: 480\n";
constexpr char kOnTheNextLine[] =
    "Camera.fx:\n  517.3\n"
    "Camera.fy: 516.5\n"
    "Camera.cx: 318.6\n"
    "Camera.cy: 255.3\n"
    "Camera.width: 640\n"
    "Camera.height: 480\n"
    "depth_translation: [0.1,\n  0.2, 0.3]\n";
constexpr char kIndented[] =
    "  Camera.fx: 517.3\n"
    "  Camera.fy: 516.5\n"
    "  Camera.cx: 318.6\n"
    "  Camera.cy: 255.3\n"
    "  Camera.width: 640\n"
    "  Camera.height: 480\n";
const std::string kOfTwoDocuments = kPlain + "---\nCamera.fx: 1\n";
constexpr char kOfOneNumber[] =
    "Camera.fx: &f 517.3\n"
    "Camera.fy: *f\n"
    "Camera.cx: 318.6\n"
    "Camera.cy: 255.3\n"
    "Camera.width: 640\n"
    "Camera.height: 480\n"
    "Camera.fps: *f\n";
constexpr char kOfOneList[] =
    "cam0:\n"
    "  camera_model: pinhole\n"
    "  distortion_model: radtan\n"
    "  intrinsics: &four [300, 300, 160, 120]\n"
    "  distortion_coeffs: [0, 0, 0, 0]\n"
    "  also: *four\n"
    "  resolution: [320, 240]\n";

INSTANTIATE_TEST_SUITE_P(OddCameraFiles, EveryLayoutTest,
                         testing::Values(kOnOneLine, kQuoted, kOnTheNextLine,
                                         kIndented, kOfTwoDocuments,
                                         kOfOneNumber, kOfOneList));

TEST_F(CameraFileWriterTest, FilesOfOpenCVStayThose) {
  const std::string ros =
      folder_.Write("ros.yaml", std::string("%YAML:1.0\n---\n") + kRos);
  const RgbdCamera camera = Changed(ResolveCamera(ros));
  const std::string text = FormatCameraFile(camera, ros);
  EXPECT_EQ(text.rfind("%YAML:1.0\n", 0), 0u);
  ExpectEqual(ResolveCamera(folder_.Write("again.yaml", text)), camera);
}

TEST_F(CameraFileWriterTest, OtherLinesAndKeysStay) {
  const std::string orb = folder_.Write("orb.yaml", kOrbSlam3);
  const RgbdCamera camera = Changed(ResolveCamera(orb));
  const std::string text = FormatCameraFile(camera, orb);
  EXPECT_NE(text.find("File.version: \"1.0\"\n"), std::string::npos);
  EXPECT_NE(text.find("Camera1.fx: 510.125\n"), std::string::npos);
  EXPECT_NE(text.find("  data: [1.0, 0.0]\n"), std::string::npos);
  const std::string ros = folder_.Write("ros.yaml", kRos);
  EXPECT_NE(FormatCameraFile(camera, ros).find("camera_name: rgb"),
            std::string::npos);
}

TEST_F(CameraFileWriterTest, OfTwoDepthScalesTheOneThatIsReadChanges) {
  const std::string both = folder_.Write(
      "both.yaml", std::string(kOrbSlam3) + "DepthMapFactor: 900.0\n");
  const RgbdCamera camera = Changed(ResolveCamera(both));
  const std::string text = FormatCameraFile(camera, both);
  ExpectEqual(ResolveCamera(folder_.Write("new.yaml", text)), camera);
  EXPECT_NE(text.find("RGBD.DepthMapFactor: 1000.0\n"), std::string::npos);
}

TEST_F(CameraFileWriterTest, CommentsStay) {
  const std::string file = folder_.Write("quoted.yaml", kQuoted);
  const std::string text = FormatCameraFile(Changed(ResolveCamera(file)), file);
  EXPECT_NE(text.find("Camera.fy: 509.5 # as measured\n"), std::string::npos);
  EXPECT_NE(text.find("said\nCamera.fx: 1\n"), std::string::npos);
}

TEST_F(CameraFileWriterTest, WhatALayoutDoesNotHoldGoesIntoAnother) {
  const std::string kalibr = folder_.Write("kalibr.yaml", kKalibr);
  RgbdCamera camera = Changed(ResolveCamera(kalibr));
  EXPECT_EQ(FormatCameraFile(camera, kalibr).find('#'), std::string::npos);
  camera.camera.k3 = 0.03;
  const std::string text = FormatCameraFile(camera, kalibr);
  ExpectEqual(ResolveCamera(folder_.Write("new.yaml", text)), camera);
  EXPECT_NE(text.find("# The layout of the original file"), std::string::npos);
}

// yaml-cpp cannot read its own output for a key that is a list.
TEST_F(CameraFileWriterTest, WhatCannotBeWrittenAgainIsLeftOut) {
  const std::string odd = folder_.Write(
      "odd.yaml", "? []\n: a].}?\n: 30:\n" + std::string(kKalibr));
  const RgbdCamera camera = Changed(ResolveCamera(odd));
  ExpectWritten(camera, odd);
}

TEST_F(CameraFileWriterTest, PresetsBecomeFiles) {
  const RgbdCamera preset = *CameraPreset("tum_fr1");
  ASSERT_NE(preset.color_shutter.readout, 0.0);
  ExpectWritten(preset, "tum_fr1");
  ExpectWritten(Changed(preset), "tum_fr1");
}

}  // namespace
}  // namespace rgbd_pose
