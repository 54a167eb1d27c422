#include <algorithm>
#include <cmath>
#include <map>

#include "core/util/input_error.h"
#include "core/util/units.h"
#include "frontend/bags/bag_topics.h"
#include "frontend/bags/ros_image.h"
#include "frontend/bags/transform_tree.h"

namespace rgbd_pose {
namespace {

// The coordinate frame of an image topic and what its images hold.
struct ImageTraits {
  std::string frame_id;
  RosImageUse use = RosImageUse::kOther;
};

ImageTraits TraitsOf(BagReader* bag, int topic) {
  const std::vector<BagMessage> first = bag->First(topic, 1);
  if (first.empty()) {
    throw InputError(bag->path() + ": " + bag->topics()[topic].name +
                     ": has no messages");
  }
  const RosImage image = ReadImageOf(*bag, first.front());
  return {std::string(image.header.frame_id),
          UseOfEncoding(std::string(image.encoding))};
}

std::optional<Camera> ReadCamera(BagReader* bag, int info_topic,
                                 int image_topic) {
  if (info_topic < 0) return std::nullopt;
  const std::vector<BagMessage> first = bag->First(info_topic, 1);
  if (first.empty()) return std::nullopt;
  return CameraOfInfo(ReadMessage(*bag, first.front(), ReadRosCameraInfo),
                      Contains(bag->topics()[image_topic].name, "rect"),
                      bag->path() + ": " + bag->topics()[info_topic].name);
}

// A topic of the RealSense viewer like /device_0/sensor_0/Depth_0/image/data.
struct ViewerTopic {
  std::string stream;  // /device_0/sensor_0/Depth_0
  std::string sensor;  // /device_0/sensor_0
};

std::optional<ViewerTopic> ViewerTopicOf(const std::string& name) {
  const std::string ending = "/image/data";
  if (name.rfind("/device_", 0) != 0 || name.size() < ending.size() ||
      name.compare(name.size() - ending.size(), ending.size(), ending) != 0) {
    return std::nullopt;
  }
  ViewerTopic topic;
  topic.stream = name.substr(0, name.size() - ending.size());
  topic.sensor = topic.stream.substr(0, topic.stream.rfind('/'));
  return topic;
}

// Raw units per metre, from the inverse that the viewer records as an option.
std::optional<double> ViewerDepthScale(BagReader* bag, int depth) {
  const auto viewer = ViewerTopicOf(bag->topics()[depth].name);
  if (!viewer.has_value()) return std::nullopt;
  const std::string name = viewer->sensor + "/option/Depth_Units/value";
  const int topic = bag->FindTopic(name);
  if (topic < 0) return std::nullopt;
  const auto first = bag->First(topic, 1);
  if (first.empty() || bag->topics()[topic].type != "std_msgs/Float32") {
    return std::nullopt;
  }
  const double metres = ReadMessage(*bag, first.front(), [](WireReader reader) {
    return reader.Number<float>();
  });
  if (!(metres > 1e-6 && metres < 1.0)) return std::nullopt;
  // Rounding turns the float nearest to 0.001 into exactly 1000.
  return std::round(1e3 / metres) / 1e3;
}

// stream_from_reference of the viewer's topics .../tf/REFERENCE, by reference.
std::map<std::string, Rigid3d> ViewerTransforms(BagReader* bag, int topic) {
  std::map<std::string, Rigid3d> transforms;
  const auto viewer = ViewerTopicOf(bag->topics()[topic].name);
  if (!viewer.has_value()) return transforms;
  const std::string prefix = viewer->stream + "/tf/";
  for (size_t i = 0; i < bag->topics().size(); ++i) {
    const BagTopic& candidate = bag->topics()[i];
    if (candidate.name.rfind(prefix, 0) != 0 ||
        candidate.type != "geometry_msgs/Transform") {
      continue;
    }
    const auto first = bag->First(static_cast<int>(i), 1);
    if (first.empty()) continue;
    Rigid3d transform = ReadMessage(*bag, first.front(), [](WireReader reader) {
      return ReadRosTransform(&reader);
    });
    if (!transform.IsFinite() || transform.rotation.norm() < 0.5) continue;
    transform.rotation.normalize();
    transforms[candidate.name.substr(prefix.size())] = transform;
  }
  return transforms;
}

// target_from_source by the transforms at the beginning of the bag.
std::optional<Rigid3d> FixedTransform(BagReader* bag, const BagTopics& topics,
                                      const std::string& target,
                                      const std::string& source) {
  constexpr int kManyMessages = 500;  // several seconds
  TransformTree tree;
  for (const int topic : topics.transforms) {
    for (const BagMessage& message : bag->First(topic, kManyMessages)) {
      for (const RosTransform& transform :
           ReadMessage(*bag, message, ReadRosTransforms)) {
        tree.Add(std::string(transform.header.frame_id),
                 std::string(transform.child_frame_id), transform.header.stamp,
                 transform.parent_from_child);
      }
    }
  }
  return tree.Fixed(target, source);
}

// Turns the camera of the full image into the camera of the cropped and binned
// image. The centre of a binned pixel is the middle of the merged pixels.
void CropAndBin(const RosCameraInfo& info, Camera* camera) {
  const uint32_t bin_x = std::max(info.binning_x, 1u);
  const uint32_t bin_y = std::max(info.binning_y, 1u);
  const bool is_part = info.roi_width > 0 && info.roi_height > 0;
  const auto size = [](uint32_t full, uint32_t part, bool is_part,
                       uint32_t bin) {
    return static_cast<int>(std::min((is_part ? part : full) / bin, 1u << 20));
  };
  camera->width = size(info.width, info.roi_width, is_part, bin_x);
  camera->height = size(info.height, info.roi_height, is_part, bin_y);
  camera->fx /= bin_x;
  camera->fy /= bin_y;
  camera->cx = (camera->cx - info.x_offset + 0.5) / bin_x - 0.5;
  camera->cy = (camera->cy - info.y_offset + 0.5) / bin_y - 0.5;
}

// color_from_depth; nothing if depth is registered to colour.
std::optional<Rigid3d> ColorFromDepth(BagReader* bag, const BagTopics& topics,
                                      const ImageTraits& color,
                                      const ImageTraits& depth,
                                      bool has_camera) {
  const auto of_color = ViewerTransforms(bag, topics.color);
  for (const auto& [reference, transform] :
       ViewerTransforms(bag, topics.depth)) {
    const auto same = of_color.find(reference);
    if (same != of_color.end()) return same->second * transform.Inverse();
  }
  const std::string& name = bag->topics()[topics.depth].name;
  if (color.frame_id == depth.frame_id || IsCalledRegistered(name)) {
    return std::nullopt;
  }
  std::optional<Rigid3d> fixed =
      FixedTransform(bag, topics, color.frame_id, depth.frame_id);
  if (!fixed.has_value() && !has_camera) {
    throw InputError(bag->path() + ": no transform from '" + depth.frame_id +
                     "' (depth) to '" + color.frame_id +
                     "' (colour); give both cameras (a Kalibr file: camera, "
                     "depth_camera), or camera alone if depth is registered to "
                     "colour");
  }
  return fixed;
}

}  // namespace

Camera CameraOfInfo(const RosCameraInfo& info, bool is_rectified,
                    const std::string& name) {
  Camera camera;
  const bool by_p = is_rectified && info.p[0] > 0.0;
  camera.fx = by_p ? info.p[0] : info.k[0];
  camera.fy = by_p ? info.p[5] : info.k[4];
  camera.cx = by_p ? info.p[2] : info.k[2];
  camera.cy = by_p ? info.p[6] : info.k[5];
  CropAndBin(info, &camera);
  const std::string model(info.distortion_model);
  // librealsense uses the last name.
  const bool is_equidistant = model == "equidistant" || model == "fisheye" ||
                              model == "Kannala Brandt4";
  const bool is_distorted =
      !by_p && !info.d.empty() &&
      (is_equidistant ||
       std::any_of(info.d.begin(), info.d.end(),
                   [](double value) { return value != 0.0; }));
  if (is_distorted) {
    const bool is_known = is_equidistant || model.empty() ||
                          model == "plumb_bob" || model == "Brown Conrady" ||
                          model == "rational_polynomial";
    // For fisheye lenses RealSense adds a fifth coefficient, which is 0.
    std::vector<double> coefficients(info.d.begin(), info.d.end());
    if (is_equidistant && coefficients.size() == 5 && coefficients[4] == 0.0) {
      coefficients.pop_back();
    }
    if (!is_known ||
        !camera.SetDistortion(
            is_equidistant ? LensModel::kEquidistant : LensModel::kRational,
            coefficients)) {
      throw InputError(name + ": distortion '" + model + "' with " +
                       std::to_string(info.d.size()) +
                       " coefficients is not supported, only plumb_bob (4 or "
                       "5), rational_polynomial (8) and equidistant (4); give "
                       "a calibration file (camera)");
    }
  }
  const std::string problem = camera.fx == 0.0
                                  ? "the camera is not calibrated (K is 0)"
                                  : camera.Check();
  if (!problem.empty()) {
    throw InputError(name + ": " + problem +
                     "; give a calibration file or a preset (camera)");
  }
  return camera;
}

std::optional<CameraSetup> CameraOfBag(BagReader* bag, const BagTopics& topics,
                                       bool has_camera) {
  const ImageTraits color = TraitsOf(bag, topics.color);
  const ImageTraits depth = TraitsOf(bag, topics.depth);
  CameraSetup setup;
  if (!has_camera) {
    const std::optional<Camera> camera =
        ReadCamera(bag, topics.color_info, topics.color);
    if (!camera.has_value()) {
      std::string others;
      for (const BagTopic& topic : bag->topics()) {
        if (topic.type == "sensor_msgs/CameraInfo") {
          others += (others.empty() ? "" : ", ") + topic.name;
        }
      }
      if (others.empty()) return std::nullopt;  // no CameraInfo
      throw InputError(bag->path() + ": has no CameraInfo next to " +
                       bag->topics()[topics.color].name + ", only " + others +
                       "; choose it (topics=COLOUR,DEPTH,CAMERA_INFO), or give "
                       "a calibration file or a preset (camera)");
    }
    setup.camera = *camera;
  }
  setup.depth_scale =
      depth.use == RosImageUse::kMetricDepth
          ? kMetricDepthScale
          : ViewerDepthScale(bag, topics.depth).value_or(kMillimetresPerMetre);
  const std::optional<Rigid3d> color_from_depth =
      ColorFromDepth(bag, topics, color, depth, has_camera);
  if (!color_from_depth.has_value()) return setup;
  const std::optional<Camera> depth_camera =
      ReadCamera(bag, topics.depth_info, topics.depth);
  if (depth_camera.has_value()) {
    setup.depth_camera = DepthCamera{*depth_camera, *color_from_depth};
  } else if (!has_camera) {
    throw InputError(bag->path() + ": " + bag->topics()[topics.depth].name +
                     ": is from a different camera than colour and has no "
                     "CameraInfo; give both cameras (a Kalibr file: camera, "
                     "depth_camera)");
  }
  return setup;
}

}  // namespace rgbd_pose
