#include <gtest/gtest.h>

#include "frontend/files/camera_file.h"
#include "tests/support/camera_file_samples.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

TEST(CameraKeysTest, ThatAreNearlyRightAreRefused) {
  const auto with = [](const char* text, const char* line) {
    return std::string(text) + line + "\n";
  };
  const struct {
    std::string text;
    std::string problem;  // line, key and suggestion
  } kCases[] = {
      {with(kRos, "DepthMapfactor: 1000"),
       "yaml:13: DepthMapfactor is no key of camera files; did you mean "
       "DepthMapFactor?"},
      {Replace(kOrbSlam3, "RGBD.Depth", "RGBD.depth"),
       "did you mean RGBD.DepthMapFactor?"},
      {with(kOrbSlam2, "color_readot: 0.028"), "did you mean color_readout?"},
      {with(kOrbSlam2, "Colour_readout: 0.028"), "did you mean color_readout?"},
      {with(kOrbSlam2, "depth-readout: 0.028"), "did you mean depth_readout?"},
      {with(kOrbSlam2, "invers_depth_offset: 0.01"),
       "did you mean inverse_depth_offset?"},
      {Replace(kOrbSlam2, "Camera.k3", "Camra.k3"), "did you mean Camera.k3?"},
      {Replace(kOrbSlam2, "Camera.k3", "Camera.K3"), "did you mean Camera.k3?"},
      {Replace(kRos, "distortion_model", "distorsion_model"),
       "yaml:8: distorsion_model is no key"},
      {Replace(kKalibr, "distortion_model: radtan", "distortion_modl: radtan"),
       "yaml:4: cam0.distortion_modl is no key of camera files; did you mean "
       "distortion_model?"}};
  for (const auto& bad : kCases) {
    ExpectInputError([&] { ReadCameraText(bad.text, "a.yaml", "cam0"); },
                     {"a.yaml", bad.problem});
  }
}

TEST(CameraKeysTest, OfOthersAreNamedUnlessProgramsOfTheLayoutHaveThem) {
  for (const char* const text : {kOrbSlam2, kOrbSlam3, kRos, kKalibr}) {
    EXPECT_EQ(ReadCameraText(text, "a.yaml", "cam0").remark, "") << text;
  }
  const std::string of_orb_slam =
      "Camera.bf: 40.0\nCamera.RGB: 1\nThDepth: 40.0\n"
      "ORBextractor.nFeatures: 1000\nViewer.KeyFrameSize: 0.05\n"
      "Camera.newWidth: 600\nCamera.newHeight: 350\nStereo.b: 0.07\n";
  EXPECT_EQ(ReadCameraText(kOrbSlam2 + of_orb_slam, "a.yaml").remark, "");
  EXPECT_EQ(
      ReadCameraText(
          std::string(kOrbSlam2) + "Camera.id: 3\ndepth_unit: 1000\n", "a.yaml")
          .remark,
      "a.yaml: unknown keys, which are not read: Camera.id, depth_unit");
  // A key at the wrong place.
  EXPECT_EQ(ReadCameraText(Replace(kKalibr, "  rostopic",
                                   "  color_readout: 0.02\n  rostopic"),
                           "a.yaml", "cam0")
                .remark,
            "a.yaml: unknown keys, which are not read: cam0.color_readout");
}

TEST(CameraKeysTest, MayBeSpeltInBritishEnglish) {
  const TempFolder folder;
  const std::string text =
      std::string(kOrbSlam2) +
      "colour_readout: 0.028  # s\ncolour_time_offset: -0.0075";
  const std::string path = folder.Write("camera.yaml", text);
  const CameraSetup setup = ReadCameraFile(path);
  EXPECT_EQ(setup.color_shutter.readout, 0.028);
  EXPECT_EQ(setup.color_shutter.offset, -0.0075);
  EXPECT_TRUE(setup.color_shutter.is_known);
  EXPECT_EQ(setup.remark, "");
  // Written again, the keys are there once.
  RgbdCamera camera = RegisteredCamera(setup);
  camera.color_shutter.readout = 0.03;
  const std::string written = FormatCameraFile(camera, path);
  EXPECT_EQ(written.find("colour_"), std::string::npos);
  EXPECT_EQ(ReadCameraText(written, path).color_shutter.readout, 0.03);
  const std::string rig =
      folder.Write("rig.yaml", std::string(kKalibr) + "colour_readout: 0.02\n");
  EXPECT_EQ(ReadCameraFile(rig, "cam0").color_shutter.readout, 0.02);
}

}  // namespace
}  // namespace rgbd_pose
