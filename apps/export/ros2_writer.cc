#include "apps/export/ros2_writer.h"

#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "apps/export/run_states.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// The fields of a message, in the language of ROS.
struct Definition {
  const char* name;
  const char* fields;
};

constexpr Definition kDefinitions[] = {
    {"builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"},
    {"std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"},
    {"geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"},
    {"geometry_msgs/Quaternion",
     "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n"},
    {"geometry_msgs/Pose",
     "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"},
    {"geometry_msgs/PoseStamped",
     "std_msgs/Header header\ngeometry_msgs/Pose pose\n"},
    {"geometry_msgs/PoseWithCovariance",
     "geometry_msgs/Pose pose\nfloat64[36] covariance\n"},
    {"geometry_msgs/Twist",
     "geometry_msgs/Vector3 linear\ngeometry_msgs/Vector3 angular\n"},
    {"geometry_msgs/TwistWithCovariance",
     "geometry_msgs/Twist twist\nfloat64[36] covariance\n"},
    {"geometry_msgs/Transform",
     "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"},
    {"geometry_msgs/TransformStamped",
     "std_msgs/Header header\nstring child_frame_id\n"
     "geometry_msgs/Transform transform\n"},
    {"nav_msgs/Odometry",
     "std_msgs/Header header\nstring child_frame_id\n"
     "geometry_msgs/PoseWithCovariance pose\n"
     "geometry_msgs/TwistWithCovariance twist\n"},
    {"nav_msgs/Path",
     "std_msgs/Header header\ngeometry_msgs/PoseStamped[] poses\n"},
    {"tf2_msgs/TFMessage", "geometry_msgs/TransformStamped[] transforms\n"},
    {"sensor_msgs/RegionOfInterest",
     "uint32 x_offset\nuint32 y_offset\nuint32 height\nuint32 width\n"
     "bool do_rectify\n"},
    {"sensor_msgs/CameraInfo",
     "std_msgs/Header header\nuint32 height\nuint32 width\n"
     "string distortion_model\nfloat64[] d\nfloat64[9] k\nfloat64[9] r\n"
     "float64[12] p\nuint32 binning_x\nuint32 binning_y\n"
     "sensor_msgs/RegionOfInterest roi\n"},
    {"sensor_msgs/PointField",
     "string name\nuint32 offset\nuint8 datatype\nuint32 count\n"},
    {"sensor_msgs/PointCloud2",
     "std_msgs/Header header\nuint32 height\nuint32 width\n"
     "sensor_msgs/PointField[] fields\nbool is_bigendian\n"
     "uint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n"},
    {"sensor_msgs/CompressedImage",
     "std_msgs/Header header\nstring format\nuint8[] data\n"},
};

// Appends the definition of a message and of those in it, each once.
void AppendDefinition(std::string_view name, std::set<std::string_view>* done,
                      std::string* text) {
  if (!done->insert(name).second) return;
  if (!text->empty()) {
    *text += std::string(80, '=') + "\nMSG: " + std::string(name) + "\n";
  }
  const std::string_view fields = FindNamed(kDefinitions, name)->fields;
  *text += fields;
  for (const std::string& field : SplitText(std::string(fields), '\n')) {
    const std::string type = field.substr(0, field.find_first_of(" ["));
    for (const Definition& definition : kDefinitions) {
      if (type == definition.name)
        AppendDefinition(definition.name, done, text);
    }
  }
}

// The schema of a message such as nav_msgs/Odometry, with those in it.
McapSchema Ros2Schema(const std::string& name) {
  McapSchema schema = {name, ""};
  schema.type.insert(name.find('/'), "/msg");
  std::set<std::string_view> done;
  AppendDefinition(name, &done, &schema.text);
  return schema;
}

}  // namespace

Ros2Writer::Ros2Writer(std::string parent, const Rigid3d& level_from_world)
    : parent_(std::move(parent)),
      parent_from_world_(UprightFromLevel() * level_from_world) {}

void Ros2Writer::WritePath(const std::string& topic, double time,
                           const Trajectory& path) {
  Write(topic, "nav_msgs/Path", time,
        PathMessage(time, path, parent_, parent_from_world_));
}

void Ros2Writer::WriteCloud(double time,
                            const std::vector<ColoredPoint>& points) {
  Write("/cloud", "sensor_msgs/PointCloud2", time,
        CloudMessage(time, points, parent_, parent_from_world_));
}

void Ros2Writer::WriteState(const CameraState& state) {
  const double time = state.pose.timestamp;
  Write("/tf", "tf2_msgs/TFMessage", time,
        TransformMessage(time, parent_,
                         parent_from_world_ * state.pose.world_from_cam));
  Write("/odom", "nav_msgs/Odometry", time,
        OdometryMessage(state, parent_, parent_from_world_));
}

void Ros2Writer::WriteImages(double time, const Camera& camera,
                             const EncodedImages& images) {
  const std::string color = "/camera/color/";
  const std::string depth = "/camera/aligned_depth_to_color/";
  const std::string info = "sensor_msgs/CameraInfo";
  const std::string image = "sensor_msgs/CompressedImage";
  Write(color + "camera_info", info, time, CameraInfoMessage(time, camera));
  Write(color + "image_raw/compressed", image, time,
        ImageMessage(time, "bgr8; jpeg compressed bgr8", images.color));
  Write(depth + "camera_info", info, time,
        CameraInfoMessage(images.depth_stamp, camera));
  Write(depth + "image_raw/compressedDepth", image, time,
        ImageMessage(images.depth_stamp, "16UC1; compressedDepth png",
                     images.depth));
}

void Ros2Writer::Write(const std::string& topic, const std::string& type,
                       double time, const std::string& message) {
  if (!file_.HasTopic(topic)) file_.AddTopic(topic, Ros2Schema(type));
  // Times of trajectories have 6 decimals.
  file_.Write(topic, 1000 * std::llround(1e6 * time), message);
}

}  // namespace rgbd_pose
