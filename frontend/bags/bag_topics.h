#pragma once

#include <optional>
#include <string>
#include <vector>

#include "frontend/bags/bag_imu.h"
#include "frontend/bags/bag_reader.h"
#include "frontend/bags/ros_messages.h"
#include "frontend/files/camera_file.h"

namespace rgbd_pose {

// The topics of an RGB-D recording.
struct BagTopics {
  std::string color;
  std::string depth;
  std::string color_info;  // CameraInfo; empty: none
  std::string depth_info;
  std::vector<std::string> transforms;  // /tf and /tf_static
  ImuTopics imu;
  // Whether other topics were suitable as well, or the name of that of depth
  // does not say so.
  bool had_choice = false;
};

// Chooses the topics given by `names` (colour, depth and, unless it is next to
// colour, CameraInfo; those of the inertial sensor in any place). What is not
// given is chosen by types, encodings and names.
// Throws InputError, which lists the topics, unless one is the most suitable.
BagTopics ChooseTopics(BagReader* bag, const std::vector<std::string>& names);

// Whether the name of a topic contains `part`.
inline bool Contains(const std::string& name, const char* part) {
  return name.find(part) != std::string::npos;
}

// Parses a message of an image topic, compressed or not.
RosImage ReadImageOf(const BagReader& bag, const BagMessage& message);

// Whether the name of a depth topic says that it is registered to colour.
bool IsCalledRegistered(const std::string& topic);

// The camera that a CameraInfo describes, for the raw or the rectified images.
// Throws InputError, which begins with `name`, if Camera cannot represent it.
Camera CameraOfInfo(const RosCameraInfo& info, bool is_rectified,
                    const std::string& name);

// The camera that a bag describes: the colour camera, the depth scale and, if
// depth is of another camera, that one with its pose from fixed transforms.
// Nothing if the bag has no CameraInfo. Throws InputError if the description is
// invalid or incomplete. With `has_camera` the colour camera is not read, and
// missing parts are no error.
std::optional<CameraSetup> CameraOfBag(BagReader* bag, const BagTopics& topics,
                                       bool has_camera);

// The pose of the inertial sensor, of whose samples this is the frame, in the
// axes of the colour camera; nothing if no fixed transforms tell it.
std::optional<Rigid3d> CamFromImu(BagReader* bag, const BagTopics& topics,
                                  const std::string& imu_frame);

}  // namespace rgbd_pose
