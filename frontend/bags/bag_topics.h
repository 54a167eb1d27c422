#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frontend/bags/bag_reader.h"
#include "frontend/bags/ros_image.h"

namespace rgbd_pose {

// What of a bag makes an RGB-D recording: places among BagReader::topics.
struct BagTopics {
  int color = -1;
  int depth = -1;
  int color_info = -1;  // CameraInfo; -1: there is none
  int depth_info = -1;
  std::vector<int> transforms;  // of /tf and /tf_static
  bool had_choice = false;      // other topics would have done, too
};

// Those that `names` says (colour, depth and, if it is not the one beside
// colour, CameraInfo), or else those that types, encodings and names tell:
// depth that is registered to colour before such that is not, raw images before
// compressed ones. Throws InputError with the topics there are if there is none
// or several will do.
BagTopics ChooseTopics(BagReader* bag, const std::vector<std::string>& names);

// Whether a topic's name has that part.
inline bool Contains(const std::string& name, const char* part) {
  return name.find(part) != std::string::npos;
}

// A message of an image topic, compressed or not.
RosImage ReadImageOf(const BagReader& bag, const BagMessage& message);

}  // namespace rgbd_pose
