#include <gtest/gtest.h>

#include <string>

#include "apps/batch/batch_plan.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

TEST(HashProgramTest, IsOfItsContentWhereverItIs) {
  const TempFolder folder;
  folder.Write("a/program", "one");
  folder.Write("b/program", "one");
  folder.Write("c/program", "two");
  EXPECT_EQ(HashProgram(folder / "a/program"),
            HashProgram(folder / "b/program"));
  EXPECT_NE(HashProgram(folder / "a/program"),
            HashProgram(folder / "c/program"));
}

class HashSequenceTest : public testing::Test {
 protected:
  HashSequenceTest() { WriteSequence("s"); }

  void WriteSequence(const std::string& name) const {
    folder_.Write(name + "/rgb.txt", "1 rgb/1.png\n2 rgb/2.png\n");
    folder_.Write(name + "/depth.txt", "1 depth/1.png\n");
    folder_.Write(name + "/rgb/1.png", "x");
    folder_.Write(name + "/rgb/2.png", "xx");
    folder_.Write(name + "/depth/1.png", "xxx");
    folder_.Write(name + "/camera.yaml", "fx: 500");
  }

  std::string Hash(const std::string& name = "s") const {
    const std::string folder = folder_ / name;
    return HashSequence({name, folder, folder + "/camera.yaml"});
  }

  const TempFolder folder_;
};

TEST_F(HashSequenceTest, DoesNotDependOnThePlace) {
  WriteSequence("t");
  EXPECT_EQ(Hash("s"), Hash("t"));
}

TEST_F(HashSequenceTest, SeesEveryInput) {
  const std::string before = Hash();
  const struct {
    const char* file;
    const char* text;
  } kChanges[] = {
      {"s/rgb.txt", "1 rgb/1.png\n2.5 rgb/2.png\n"},
      {"s/depth.txt", "1 depth/1.png\n2 depth/2.png\n"},
      {"s/rgb/2.png", "xxx"},
      {"s/depth/1.png", ""},
      {"s/camera.yaml", "fx: 501"},
      {"s/groundtruth.txt", ""},
      {"s/calibration.txt", "500 500 320 240"},
      {"s/imu.csv", "1.0,0,0,0,0,0,9.8"},
      {"s/imu.txt", "1.0,0,0,0,0,0,9.8"},
      {"s/accelerometer.txt", "1.0 0 0 9.8"},
      {"s/imu.yaml", "timeshift_cam_imu: 0"},
      {"s/mask/1.png", "xxxx"},
  };
  for (const auto& change : kChanges) {
    const TempFolder& folder = folder_;
    folder.Write(change.file, change.text);
    EXPECT_NE(Hash(), before) << change.file;
    std::filesystem::remove(folder / change.file);
    WriteSequence("s");
    EXPECT_EQ(Hash(), before) << "all is as it was before " << change.file;
  }
}

// The mounting of an inertial sensor is also read where the list names another
// camera.
TEST_F(HashSequenceTest, SeesTheCameraFileBesideAPreset) {
  const BatchSequence sequence = {"s", folder_ / "s", "tum_fr1"};
  const std::string before = HashSequence(sequence);
  folder_.Write("s/camera.yaml", "timeshift_cam_imu: 0.1");
  EXPECT_NE(HashSequence(sequence), before);
}

TEST_F(HashSequenceTest, TakesBrokenSequences) {
  folder_.Write("s/rgb.txt", "oops\n");
  const std::string broken = Hash();
  std::filesystem::remove(folder_ / "s/rgb.txt");
  EXPECT_NE(Hash(), broken);
  EXPECT_NE(HashSequence({"s", folder_ / "s", "tum_fr1"}),
            HashSequence({"s", folder_ / "s", "tum_fr2"}));
}

}  // namespace
}  // namespace rgbd_pose
