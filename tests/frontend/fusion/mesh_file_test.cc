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

TEST(PlyWriterTest, NamesThePathThatCannotBeWritten) {
  const TempFolder folder;
  const std::string path = folder / "missing/cloud.ply";
  ExpectInputError([&path] { WritePly(path, {}); }, {path});
}

}  // namespace
}  // namespace rgbd_pose
