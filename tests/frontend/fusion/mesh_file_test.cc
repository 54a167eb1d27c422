#include "frontend/fusion/mesh_file.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/util/text_file.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

// Checks every byte, because other programs read this format.
TEST(PlyWriterTest, WritesTheBytesOfTheFormat) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\n"
      "property float x\nproperty float y\nproperty float z\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "end_header\n";
  const unsigned char data[] = {
      0x00, 0x00, 0x80, 0x3F,  // 1
      0x00, 0x00, 0x00, 0xC0,  // -2
      0x00, 0x00, 0x20, 0x3F,  // 0.625
      0x01, 0x80, 0xFF,        // colour
      0x00, 0x00, 0x00, 0x00,  //
      0x00, 0x00, 0x00, 0x00,  //
      0xDB, 0x0F, 0x49, 0x40,  // pi
      0x00, 0x00, 0x00,
  };
  const std::string bytes =
      FormatMeshPly({{{Eigen::Vector3f(1.0F, -2.0F, 0.625F), {1, 128, 255}},
                      {Eigen::Vector3f(0.0F, 0.0F, 3.14159265F), {}}},
                     {}});
  EXPECT_EQ(bytes, header + std::string(reinterpret_cast<const char*>(data),
                                        sizeof(data)));
}

TEST(PlyWriterTest, WritesAFileAsAWhole) {
  const TempFolder folder;
  const std::vector<ColoredPoint> points(1000);
  WritePly(folder / "cloud.ply", points);
  EXPECT_EQ(ReadTextFile(folder / "cloud.ply"), FormatMeshPly({points, {}}));
  EXPECT_FALSE(std::filesystem::exists(folder / "cloud.ply.partial"));
  WritePly(folder / "empty.ply", {});
  EXPECT_EQ(ReadTextFile(folder / "empty.ply"), FormatMeshPly({}));
}

// In an upright world z points up and y ahead.
TEST(GlbTest, AnUprightWorldIsTheSameSceneAsALevelOne) {
  Eigen::Matrix3d level_from_upright;
  level_from_upright << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  TriangleMesh level, upright;
  for (const Eigen::Vector3f& p :
       {Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(-4, 5, 6),
        Eigen::Vector3f(7, -8, 9)}) {
    level.vertices.push_back({p, {}});
    upright.vertices.push_back(
        {level_from_upright.transpose().cast<float>() * p, {}});
  }
  level.triangles = upright.triangles = {{0, 1, 2}};
  EXPECT_NE(FormatGlb(upright), FormatGlb(level));
  EXPECT_EQ(FormatGlb(upright, Rigid3d(Eigen::Quaterniond(level_from_upright),
                                       {0, 0, 0})),
            FormatGlb(level));
}

TEST(PlyWriterTest, NamesThePathThatCannotBeWritten) {
  const TempFolder folder;
  const std::string path = folder / "missing/cloud.ply";
  ExpectInputError([&path] { WritePly(path, {}); }, {path});
}

}  // namespace
}  // namespace rgbd_pose
