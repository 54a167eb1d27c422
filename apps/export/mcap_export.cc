// Exports a run for Foxglove's viewer: JSON messages of the types in
// docs.foxglove.dev/docs/sdk/schemas, in an mcap file.

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/export/export_format.h"
#include "apps/export/mcap_writer.h"
#include "apps/export/run_states.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/files/jpeg_codec.h"

namespace rgbd_pose {
namespace {

using Json = nlohmann::json;

// The schema of a message, whose lists must not be empty. Text named "data" is
// base64, as in all Foxglove types.
Json SchemaOf(const Json& value) {
  if (value.is_array()) {
    return {{"type", "array"}, {"items", SchemaOf(value.front())}};
  }
  if (!value.is_object()) {
    return {{"type", value.is_number() ? "number" : "string"}};
  }
  Json properties;
  for (const auto& [name, field] : value.items()) {
    properties[name] = SchemaOf(field);
    if (name == "data") properties[name]["contentEncoding"] = "base64";
  }
  return {{"type", "object"}, {"properties", properties}};
}

// Foxglove's z axis points up, and it shows the frame "map" by default. That is
// our world with x forward, y left and z up.
constexpr char kMap[] = "map", kWorld[] = "world", kCamera[] = "camera";

Json VectorOf(const Eigen::Vector3d& v) {
  return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}};
}

Json QuaternionOf(const Eigen::Quaterniond& q) {
  return {{"x", q.x()}, {"y", q.y()}, {"z", q.z()}, {"w", q.w()}};
}

Json PoseOf(const Rigid3d& pose) {
  return {{"position", VectorOf(pose.translation)},
          {"orientation", QuaternionOf(pose.rotation)}};
}

Json FrameTransform(const char* parent, const char* child,
                    const Rigid3d& parent_from_child) {
  return {{"parent_frame_id", parent},
          {"child_frame_id", child},
          {"translation", VectorOf(parent_from_child.translation)},
          {"rotation", QuaternionOf(parent_from_child.rotation)}};
}

Json PosesInFrame(const Trajectory& path) {
  Json poses;
  for (const StampedPose& pose : path) {
    poses.push_back(PoseOf(pose.world_from_cam));
  }
  return {{"frame_id", kWorld}, {"poses", poses}};
}

Json CameraCalibration(const Camera& camera) {
  const std::vector<double> distortion = camera.Distortion();
  const bool is_fisheye = camera.lens_model == LensModel::kEquidistant;
  const char* const model = is_fisheye               ? "kannala_brandt"
                            : distortion.size() == 8 ? "rational_polynomial"
                                                     : "plumb_bob";
  const double fx = camera.fx, fy = camera.fy, cx = camera.cx, cy = camera.cy;
  return {{"frame_id", kCamera},
          {"width", camera.width},
          {"height", camera.height},
          {"distortion_model", model},
          {"D", distortion},
          {"K", {fx, 0, cx, 0, fy, cy, 0, 0, 1}},
          {"R", {1, 0, 0, 0, 1, 0, 0, 0, 1}},
          {"P", {fx, 0, cx, 0, 0, fy, cy, 0, 0, 0, 1, 0}}};
}

Json PointCloud(const std::vector<ColoredPoint>& points) {
  constexpr int kUint8 = 1, kFloat32 = 7;
  std::string bytes;
  for (const ColoredPoint& p : points) {
    for (const float x : p.position) AppendLittleEndian(x, &bytes);
    bytes.append(p.color.begin(), p.color.end());
    bytes.push_back('\xFF');
  }
  Json fields;
  int offset = 0;
  for (const char* const name : {"x", "y", "z"}) {
    fields.push_back({{"name", name}, {"offset", offset}, {"type", kFloat32}});
    offset += sizeof(float);
  }
  for (const char* const name : {"red", "green", "blue", "alpha"}) {
    fields.push_back({{"name", name}, {"offset", offset++}, {"type", kUint8}});
  }
  return {{"frame_id", kWorld},
          {"pose", PoseOf(Rigid3d())},
          {"point_stride", offset},
          {"fields", fields},
          {"data", Base64(bytes)}};
}

// The poses of the path that are keyframes of the run's map, if it has one.
Trajectory KeyframePath(const FinishedRun& run, const Trajectory& path) {
  const std::optional<CsvTable> table = KeyframesOf(run);
  if (!table.has_value()) return {};
  const std::vector<double> column = table->Numbers("timestamp");
  const std::set<double> times(column.begin(), column.end());
  Trajectory keyframes;
  for (const StampedPose& pose : path) {
    if (times.count(pose.timestamp) != 0) keyframes.push_back(pose);
  }
  return keyframes;
}

}  // namespace

std::string ExportMcap(const FinishedRun& run, const ExportOptions& options) {
  const Trajectory path = TimedPath(run, "Foxglove");
  RequireWritable(options.output);
  // Images are kept in memory, because the cloud, which needs all frames, comes
  // first.
  std::map<double, std::string> images;  // by time
  const ExportedViews views =
      ReadImages(run, options, [&](const Frame& frame, int view) {
        images[run.trajectory[view].timestamp] = EncodeJpeg(frame.color, 90);
      });

  McapWriter file("", "json");
  // Time stamps of trajectories have 6 decimals.
  constexpr uint64_t kMicro = 1000, kSecond = 1000000000;  // ns
  const auto write = [&file](const char* topic, const std::string& type,
                             double seconds, Json message) {
    const uint64_t time = kMicro * std::llround(1e6 * seconds);
    message["timestamp"] = {{"sec", time / kSecond}, {"nsec", time % kSecond}};
    if (!file.HasTopic(topic)) {
      file.AddTopic(
          topic, {"foxglove." + type, "jsonschema", SchemaOf(message).dump()});
    }
    file.Write(topic, time, message.dump());
  };
  const double start = path[0].timestamp;
  write(
      "/tf_static", "FrameTransform", start,
      FrameTransform(kMap, kWorld, UprightFromLevel() * run.level_from_world));
  write("/path", "PosesInFrame", start, PosesInFrame(path));
  const Trajectory keyframes = KeyframePath(run, path);
  if (!keyframes.empty()) {
    write("/keyframes", "PosesInFrame", start, PosesInFrame(keyframes));
  }
  write("/cloud", "PointCloud", start, PointCloud(views.cloud));
  for (const auto& [time, world_from_cam] : path) {
    write("/tf", "FrameTransform", time,
          FrameTransform(kWorld, kCamera, world_from_cam));
    const auto image = images.find(time);
    if (image == images.end()) continue;
    write("/camera/calibration", "CameraCalibration", time,
          CameraCalibration(views.camera));
    write("/camera/image", "CompressedImage", time,
          {{"frame_id", kCamera},
           {"format", "jpeg"},
           {"data", Base64(std::exchange(image->second, {}))}});
  }
  WriteFileAtomically(options.output, file.Finish());
  return Format("%zu poses, %zu images, %zu points in %s\n", path.size(),
                images.size(), views.cloud.size(), options.output.c_str()) +
         LeftOut(run.segments.size() - path.size());
}

}  // namespace rgbd_pose
