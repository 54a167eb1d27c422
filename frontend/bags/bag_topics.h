#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frontend/bags/bag_reader.h"
#include "frontend/bags/ros_image.h"
#include "frontend/bags/ros_messages.h"
#include "frontend/files/camera_setup.h"

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

// Whether by its name a topic of depth is registered to colour.
bool IsCalledRegistered(const std::string& topic);

// The camera of the images of a CameraInfo: of the raw image or the rectified
// one. Throws InputError, which begins with `name`, for one that Camera does
// not have.
Camera CameraOfInfo(const RosCameraInfo& info, bool is_rectified,
                    const std::string& name);

// What a bag says of its camera: that of colour, how depth counts, and that of
// depth if it is another one, whose place is then said by transforms that do
// not change. Throws InputError for what makes no sense or is said by nobody;
// not where `has_camera`: then nothing is taken but the depth scale and, if it
// is there, the depth camera.
std::optional<CameraSetup> CameraOfBag(BagReader* bag, const BagTopics& topics,
                                       bool has_camera);

}  // namespace rgbd_pose
