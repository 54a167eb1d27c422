#include <gtest/gtest.h>

#include "frontend/slam/map_folder.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/map_parts.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

TEST(MapIndexTest, RefusesAChangedByte) {
  const std::string text = FormatMapIndex(NoiseMap(2, 0));
  const auto expect_refused = [](const std::string& changed) {
    ExpectInputError([&] { ParseMapIndex(changed, "map.txt"); }, {"map.txt: "});
  };
  for (size_t i = 0; i < 8 * text.size(); ++i) {
    SCOPED_TRACE(i);
    std::string changed = text;
    changed[i / 8] ^= 1 << i % 8;
    expect_refused(changed);
  }
  for (size_t size = 0; size < text.size(); ++size) {
    expect_refused(text.substr(0, size));
  }
  expect_refused(text + "\n");
}

TEST(MapIndexTest, RefusesWrongLines) {
  const std::string kStart = "rgbd_pose_map 1\n";
  const std::string kCamera = "camera 32 24 30 30 15.5 11.5 0 0 0 0 0\n";
  const std::string kPose = " 0 0 1 5000 0 0 0 0 0 0 1 ";
  const std::string kName = "0123456789abcdef";
  const TempFolder folder;
  const struct {
    std::string lines;
    std::string message;
  } kCases[] = {
      {"", "map.txt: has no camera"},
      {"keyframe 0\n", "map.txt:2: there must be one camera line"},
      {kCamera + kCamera, "map.txt:3: there must be one camera line"},
      {"camera 32\n", "map.txt:2: a line 'camera' must have 12 words"},
      {kCamera.substr(0, kCamera.size() - 1) + " 0 0 0 wide\n",
       "map.txt:2: lens 'wide' must be 'rational' or 'equidistant'"},
      {"camera 3.5" + kCamera.substr(9), "map.txt:2: '3.5' must be an integer"},
      {kCamera + "landmark 1\n",
       "map.txt:3: 'landmark' must be camera, keyframe, edge or up"},
      {kCamera + "keyframe 0" + kPose + kName + " ../secret\n",
       "map.txt:3: '../secret' must be an image's checksum"},
      {kCamera + "keyframe 9999999999" + kPose + kName + " " + kName + "\n",
       "map.txt:3: '9999999999' must be an integer"},
      {kCamera + "keyframe x" + kPose + kName + " " + kName + "\n",
       "map.txt:3: 'x' is not a finite number for a keyframe"},
      {kCamera + "edge 0 1 nan\n", "map.txt:3: a line 'edge' must have 46"},
      {kCamera + "up 0 0 1 0\n", "map.txt:3: a line 'up' must have 6 words"},
      {"camera 32 24 0" + kCamera.substr(15), "map.txt: camera: fx and fy"},
  };
  for (const auto& c : kCases) {
    const std::string text = kStart + c.lines;
    folder.Write("map.txt", text + ChecksumLine(text));
    ExpectInputError([&] { LoadMap(folder.path()); }, {c.message});
  }
}

}  // namespace
}  // namespace rgbd_pose
