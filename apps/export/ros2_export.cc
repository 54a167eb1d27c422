// Exports a run as a recording of ROS 2: an mcap file of messages in CDR that
// `ros2 bag play` publishes.

#include <cmath>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <string_view>

#include "apps/export/export_format.h"
#include "apps/export/mcap_writer.h"
#include "apps/export/run_states.h"
#include "core/util/format.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "frontend/bags/cdr_writer.h"

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

// The schema of a message such as nav_msgs/Odometry.
McapSchema SchemaOf(const std::string& name) {
  McapSchema schema = {name, "ros2msg", ""};
  schema.type.insert(name.find('/'), "/msg");
  std::set<std::string_view> done;
  AppendDefinition(name, &done, &schema.text);
  return schema;
}

constexpr char kCamera[] = "camera_color_optical_frame";

void WriteVector(const Eigen::Vector3d& v, CdrWriter* writer) {
  writer->Numbers({v.x(), v.y(), v.z()});
}

void WritePose(const Rigid3d& pose, CdrWriter* writer) {
  const Eigen::Quaterniond& q = pose.rotation;
  WriteVector(pose.translation, writer);
  writer->Numbers({q.x(), q.y(), q.z(), q.w()});
}

void WriteMatrix(const MotionMatrix& matrix, CdrWriter* writer) {
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) writer->Number(matrix(i, j));
  }
}

std::string TransformMessage(double stamp, const std::string& parent,
                             const Rigid3d& parent_from_cam) {
  CdrWriter writer;
  writer.Number(uint32_t{1}).Header(stamp, parent).Text(kCamera);
  WritePose(parent_from_cam, &writer);
  return writer.message();
}

std::string PathMessage(const Trajectory& path, const std::string& parent,
                        const Rigid3d& parent_from_world) {
  CdrWriter writer;
  writer.Header(path[0].timestamp, parent);
  writer.Number(static_cast<uint32_t>(path.size()));
  for (const StampedPose& pose : path) {
    writer.Header(pose.timestamp, parent);
    WritePose(parent_from_world * pose.world_from_cam, &writer);
  }
  return writer.message();
}

// Covariances are those of [position, rotation about the axes of the parent]
// and of [linear, angular] in the axes of the camera.
std::string OdometryMessage(const CameraState& state, const std::string& parent,
                            const Rigid3d& parent_from_world) {
  const Rigid3d parent_from_cam = parent_from_world * state.pose.world_from_cam;
  MotionMatrix J = MotionMatrix::Zero();
  J.topRightCorner<3, 3>() = parent_from_world.rotation.toRotationMatrix();
  J.bottomLeftCorner<3, 3>() = -parent_from_cam.rotation.toRotationMatrix();
  MotionMatrix swap = MotionMatrix::Zero();
  swap.topRightCorner<3, 3>().setIdentity();
  swap.bottomLeftCorner<3, 3>().setIdentity();
  CdrWriter writer;
  writer.Header(state.pose.timestamp, parent).Text(kCamera);
  WritePose(parent_from_cam, &writer);
  WriteMatrix(J * state.covariance * J.transpose(), &writer);
  WriteVector(state.twist.linear, &writer);
  WriteVector(state.twist.angular, &writer);
  WriteMatrix(swap * state.twist_covariance * swap.transpose(), &writer);
  return writer.message();
}

std::string CameraInfoMessage(double stamp, const Camera& camera) {
  const std::vector<double> distortion = camera.Distortion();
  const bool is_fisheye = camera.lens_model == LensModel::kEquidistant;
  const double fx = camera.fx, fy = camera.fy, cx = camera.cx, cy = camera.cy;
  CdrWriter writer;
  writer.Header(stamp, kCamera);
  writer.Number(static_cast<uint32_t>(camera.height));
  writer.Number(static_cast<uint32_t>(camera.width));
  writer.Text(is_fisheye               ? "equidistant"
              : distortion.size() == 8 ? "rational_polynomial"
                                       : "plumb_bob");
  writer.Number(static_cast<uint32_t>(distortion.size())).Numbers(distortion);
  writer.Numbers({fx, 0, cx, 0, fy, cy, 0, 0, 1});
  writer.Numbers({1, 0, 0, 0, 1, 0, 0, 0, 1});
  writer.Numbers({fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0});
  // Without binning, of the full image.
  for (int i = 0; i < 6; ++i) writer.Number(uint32_t{0});
  return writer.Number(uint8_t{0}).message();
}

std::string ImageMessage(double stamp, const std::string& format,
                         const std::string& bytes) {
  return CdrWriter().Header(stamp, kCamera).Text(format).Bytes(bytes).message();
}

// Both images of a frame as files.
struct EncodedImages {
  std::string color;         // JPEG
  std::string depth;         // as compressedDepth: a header, then PNG
  double depth_stamp = 0.0;  // s
};

EncodedImages Encode(const Frame& frame) {
  std::vector<uint8_t> jpeg, png;
  cv::imencode(".jpg", frame.color, jpeg, {cv::IMWRITE_JPEG_QUALITY, 90});
  cv::imencode(".png", DepthInMillimetres(frame), png,
               {cv::IMWRITE_PNG_COMPRESSION, 1});
  // The header has parameters of floating-point depth only.
  return {{jpeg.begin(), jpeg.end()},
          std::string(12, '\0') + std::string(png.begin(), png.end()),
          frame.timestamp + frame.depth_delay};
}

bool HasMap(const FinishedRun& run) {
  return !run.folder.empty() &&
         std::filesystem::exists(std::filesystem::path(run.folder) /
                                 "keyframes.csv");
}

}  // namespace

std::string ExportRos2(const FinishedRun& run, const ExportOptions& options) {
  const Trajectory path = TimedPath(run, "ROS");
  RequireWritable(options.output);
  std::map<double, EncodedImages> images;  // by time
  const ExportedViews views =
      ReadImages(run, options, [&](const Frame& frame, int view) {
        images[run.trajectory[view].timestamp] = Encode(frame);
      });

  McapWriter file("ros2", "cdr");
  const auto write = [&file](const std::string& topic, const std::string& type,
                             double seconds, const std::string& message) {
    // Times of trajectories have 6 decimals.
    const uint64_t time = 1000 * std::llround(1e6 * seconds);
    if (!file.HasTopic(topic)) file.AddTopic(topic, SchemaOf(type));
    file.Write(topic, time, message);
  };
  // REP 105: a map may jump, odometry does not.
  const std::string parent = HasMap(run) ? "map" : "odom";
  const Rigid3d parent_from_world = UprightFromWorld();
  write("/path", "nav_msgs/Path", path[0].timestamp,
        PathMessage(path, parent, parent_from_world));
  const std::string color = "/camera/color/";
  const std::string depth = "/camera/aligned_depth_to_color/";
  for (const CameraState& state : StatesOf(run, path)) {
    const double time = state.pose.timestamp;
    write("/tf", "tf2_msgs/TFMessage", time,
          TransformMessage(time, parent,
                           parent_from_world * state.pose.world_from_cam));
    write("/odom", "nav_msgs/Odometry", time,
          OdometryMessage(state, parent, parent_from_world));
    const auto image = images.find(time);
    if (image == images.end()) continue;
    const EncodedImages& both = image->second;
    write(color + "camera_info", "sensor_msgs/CameraInfo", time,
          CameraInfoMessage(time, views.camera));
    write(color + "image_raw/compressed", "sensor_msgs/CompressedImage", time,
          ImageMessage(time, "bgr8; jpeg compressed bgr8", both.color));
    write(depth + "camera_info", "sensor_msgs/CameraInfo", time,
          CameraInfoMessage(both.depth_stamp, views.camera));
    write(depth + "image_raw/compressedDepth", "sensor_msgs/CompressedImage",
          time,
          ImageMessage(both.depth_stamp, "16UC1; compressedDepth png",
                       both.depth));
  }
  WriteFileAtomically(options.output, file.Finish());
  return Format("%zu poses in the frame %s, %zu images in %s\n", path.size(),
                parent.c_str(), images.size(), options.output.c_str()) +
         LeftOut(run, path);
}

}  // namespace rgbd_pose
