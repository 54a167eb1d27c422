#pragma once

#include <optional>
#include <string>

#include "frontend/bags/bag_reader.h"
#include "frontend/bags/bag_topics.h"
#include "frontend/bags/ros_messages.h"
#include "frontend/files/camera_setup.h"

namespace rgbd_pose {

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
