// The text file of a map, unchanged and with a valid checksum.

#include <algorithm>

#include "frontend/slam/map_folder.h"
#include "tests/fuzz/fuzz_input.h"

namespace rgbd_pose {
namespace {

// Adds images of the camera's size, unless they are too large to be fast.
void AddImages(KeyframeMap* map) {
  constexpr int kMaxSide = 64;
  const Camera& camera = map->camera;
  if (!camera.Check().empty() ||
      std::max(camera.width, camera.height) > kMaxSide) {
    return;
  }
  Frame frame;
  frame.gray = cv::Mat::zeros(camera.height, camera.width, CV_8UC1);
  frame.depth = cv::Mat::zeros(camera.height, camera.width, CV_16UC1);
  const StoredImages images(frame);
  for (Keyframe& keyframe : map->keyframes) {
    keyframe.images.gray = images.gray;
    keyframe.images.depth = images.depth;
  }
}

void Read(const std::string& text) {
  MayRefuse([&] {
    KeyframeMap map = ParseMapIndex(text, "map.txt");
    const std::string again = FormatMapIndex(map);
    Require(FormatMapIndex(ParseMapIndex(again, "map.txt")) == again,
            "what is written is read back");
    AddImages(&map);
    const std::string wrong = map.Check();
    Require(wrong.find('\n') == std::string::npos, "one line");
  });
}

}  // namespace
}  // namespace rgbd_pose

FUZZ_TARGET(map_index) {
  using namespace rgbd_pose;
  const std::string text(FuzzText(data, size));
  Read(text);
  Read(text + ChecksumLine(text));
  return 0;
}
