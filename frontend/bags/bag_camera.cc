#include <algorithm>
#include <cmath>
#include <map>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
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

ImageTraits TraitsOf(BagReader* bag, const std::string& topic) {
  const std::vector<BagMessage> first = bag->First(topic, 1);
  if (first.empty()) {
    throw InputError(bag->path() + ": " + topic + ": has no messages");
  }
  const RosImage image = ReadImageOf(*bag, first.front());
  return {std::string(image.header.frame_id), UseOfEncoding(image.encoding)};
}

std::optional<Camera> ReadCamera(BagReader* bag, const std::string& info_topic,
                                 const std::string& image_topic) {
  if (info_topic.empty()) return std::nullopt;
  const std::vector<BagMessage> first = bag->First(info_topic, 1);
  if (first.empty()) return std::nullopt;
  return CameraOfInfo(ReadMessage(*bag, first.front(), ReadRosCameraInfo),
                      Contains(image_topic, "rect"),
                      bag->path() + ": " + info_topic);
}

// The stream of a topic of the RealSense viewer: X of X/image/data or
// X/imu/data with X = /device_0/sensor_0/Depth_0. Empty for other topics.
std::string ViewerStreamOf(const std::string& topic) {
  if (topic.rfind("/device_", 0) != 0) return "";
  for (const std::string ending : {"/image/data", "/imu/data"}) {
    if (topic.size() >= ending.size() &&
        topic.compare(topic.size() - ending.size(), ending.size(), ending) ==
            0) {
      return topic.substr(0, topic.size() - ending.size());
    }
  }
  return "";
}

// Raw units per metre, from the inverse that the viewer records as an option.
std::optional<double> ViewerDepthScale(BagReader* bag,
                                       const std::string& depth) {
  const std::string stream = ViewerStreamOf(depth);
  if (stream.empty()) return std::nullopt;
  const std::string sensor = stream.substr(0, stream.rfind('/'));
  const BagTopic* topic = bag->FindTopic(sensor + "/option/Depth_Units/value");
  if (topic == nullptr) return std::nullopt;
  const auto first = bag->First(topic->name, 1);
  if (first.empty() || topic->type != "std_msgs/Float32") return std::nullopt;
  const double metres = ReadMessage(*bag, first.front(), [](WireReader reader) {
    return reader.Number<float>();
  });
  if (!(metres > 1e-6 && metres < 1.0)) return std::nullopt;
  // Rounding turns the float nearest to 0.001 into exactly 1000.
  return std::round(1e3 / metres) / 1e3;
}

// stream_from_reference of the viewer's topics .../tf/REFERENCE, by reference.
std::map<std::string, Rigid3d> ViewerTransforms(BagReader* bag,
                                                const std::string& topic_name) {
  std::map<std::string, Rigid3d> transforms;
  const std::string stream = ViewerStreamOf(topic_name);
  if (stream.empty()) return transforms;
  const std::string prefix = stream + "/tf/";
  for (const BagTopic& topic : bag->topics()) {
    if (topic.name.rfind(prefix, 0) != 0 ||
        topic.type != "geometry_msgs/Transform") {
      continue;
    }
    const auto first = bag->First(topic.name, 1);
    if (first.empty()) continue;
    Rigid3d transform = ReadMessage(*bag, first.front(), [](WireReader reader) {
      return ReadRosTransform(&reader);
    });
    if (!transform.IsFinite() || transform.rotation.norm() < 0.5) continue;
    transform.rotation.normalize();
    transforms[topic.name.substr(prefix.size())] = transform;
  }
  return transforms;
}

// Turns the camera of the full image into that of the cropped and binned image,
// in which the centre of a pixel is the middle of the merged pixels.
void CropAndBin(const RosCameraInfo& info, Camera* camera) {
  const uint32_t bin_x = std::max(info.binning_x, 1u);
  const uint32_t bin_y = std::max(info.binning_y, 1u);
  const bool is_part = info.roi_width > 0 && info.roi_height > 0;
  const auto size = [](uint32_t pixels, uint32_t bin) {
    return static_cast<int>(std::min(pixels / bin, 1u << 20));
  };
  camera->width = size(is_part ? info.roi_width : info.width, bin_x);
  camera->height = size(is_part ? info.roi_height : info.height, bin_y);
  camera->fx /= bin_x;
  camera->fy /= bin_y;
  camera->cx = (camera->cx - info.x_offset + 0.5) / bin_x - 0.5;
  camera->cy = (camera->cy - info.y_offset + 0.5) / bin_y - 0.5;
}

// color_from_other between two topics of the RealSense viewer; nothing for
// other topics.
std::optional<Rigid3d> ColorFromViewer(BagReader* bag,
                                       const std::string& color_topic,
                                       const std::string& other_topic) {
  const auto of_color = ViewerTransforms(bag, color_topic);
  for (const auto& [reference, transform] :
       ViewerTransforms(bag, other_topic)) {
    const auto same = of_color.find(reference);
    if (same != of_color.end()) return same->second * transform.Inverse();
  }
  return std::nullopt;
}

// color_from_other between two coordinate frames, if the first transforms of
// the bag say it.
std::optional<Rigid3d> ColorFromFixed(BagReader* bag, const BagTopics& topics,
                                      const std::string& color_frame,
                                      const std::string& other_frame) {
  constexpr int kManyMessages = 500;  // several seconds
  TransformTree tree;
  for (const std::string& topic : topics.transforms) {
    for (const BagMessage& message : bag->First(topic, kManyMessages)) {
      tree.Add(ReadMessage(*bag, message, ReadRosTransforms));
    }
  }
  return tree.Fixed(color_frame, other_frame);
}

// color_from_depth; nothing if depth is registered to colour.
std::optional<Rigid3d> ColorFromDepth(BagReader* bag, const BagTopics& topics,
                                      const ImageTraits& color,
                                      const ImageTraits& depth,
                                      bool has_camera) {
  const std::optional<Rigid3d> of_viewer =
      ColorFromViewer(bag, topics.color, topics.depth);
  if (of_viewer.has_value()) return of_viewer;
  if (color.frame_id == depth.frame_id || IsCalledRegistered(topics.depth)) {
    return std::nullopt;
  }
  std::optional<Rigid3d> fixed =
      ColorFromFixed(bag, topics, color.frame_id, depth.frame_id);
  if (!fixed.has_value() && !has_camera) {
    throw InputError(bag->path() + ": no fixed transform from '" +
                     depth.frame_id + "' (depth) to '" + color.frame_id +
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
  const size_t zeros = std::count(info.d.begin(), info.d.end(), 0.0);
  if (!by_p && !info.d.empty() && (is_equidistant || zeros < info.d.size())) {
    const bool is_known = is_equidistant || model.empty() ||
                          model == "plumb_bob" || model == "Brown Conrady" ||
                          model == "rational_polynomial";
    // For fisheye lenses RealSense adds a fifth coefficient, which is 0.
    std::vector<double> coefficients = info.d;
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
      std::vector<std::string> others;
      for (const BagTopic& topic : bag->topics()) {
        if (topic.type == "sensor_msgs/CameraInfo") {
          others.push_back(topic.name);
        }
      }
      if (others.empty()) return std::nullopt;  // no CameraInfo
      throw InputError(bag->path() + ": has no CameraInfo next to " +
                       topics.color + ", only " + Join(others) +
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
    throw InputError(
        bag->path() + ": " + topics.depth +
        ": is from a different camera than colour and has no CameraInfo; give "
        "both cameras (a Kalibr file: camera, depth_camera)");
  }
  return setup;
}

std::optional<Rigid3d> CamFromImu(BagReader* bag, const BagTopics& topics,
                                  const std::string& imu_frame) {
  const std::optional<Rigid3d> of_viewer =
      ColorFromViewer(bag, topics.color, topics.imu.accel);
  if (of_viewer.has_value()) return of_viewer;
  return ColorFromFixed(bag, topics, TraitsOf(bag, topics.color).frame_id,
                        imu_frame);
}

}  // namespace rgbd_pose
