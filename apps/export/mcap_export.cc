// Exports a run for Foxglove's viewer: JSON messages of the types in
// docs.foxglove.dev/docs/sdk/schemas, in an mcap file.

#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <type_traits>
#include <utility>

#include "apps/export/export_format.h"
#include "apps/shell/csv_table.h"
#include "core/util/format.h"
#include "core/util/text_file.h"
#include "frontend/bags/mcap_format.h"

namespace rgbd_pose {
namespace {

using Json = nlohmann::json;

// Bytes after which a chunk is closed.
constexpr size_t kMcapChunkSize = 1 << 20;

constexpr std::string_view kNoText;  // no profile, codec or metadata
constexpr uint32_t kNone = 0;        // attachments and the like

// Serialises numbers in little-endian order, and texts (also lists and maps
// that are serialised already) after their length.
template <typename... Fields>
std::string Pack(const Fields&... fields) {
  std::string bytes;
  const auto append = [&bytes](const auto& field) {
    if constexpr (std::is_arithmetic_v<std::decay_t<decltype(field)>>) {
      AppendLittleEndian(field, &bytes);
    } else {
      const std::string_view text = field;
      AppendLittleEndian(static_cast<uint32_t>(text.size()), &bytes);
      bytes += text;
    }
  };
  (append(fields), ...);
  return bytes;
}

std::string RecordOf(McapOpcode opcode, const std::string& content) {
  return static_cast<char>(opcode) + Pack(uint64_t{content.size()}) + content;
}

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

// Builds an mcap file (mcap.dev/spec) of JSON messages, with uncompressed
// chunks, schemas, indexes, statistics and checksums.
class McapWriter {
 public:
  // Appends a message. The schema of the name `type` is derived from the first
  // message of a topic, whose lists must not be empty; text named "data" is
  // base64, as in all Foxglove types. Times (ns) must not decrease.
  void Write(const std::string& topic, const std::string& type, uint64_t time,
             const Json& message) {
    if (messages_++ == 0) first_time_ = time;
    if (chunk_.empty()) chunk_time_ = time;
    last_time_ = time;
    const auto [place, is_new] = channels_.try_emplace(topic);
    Channel& channel = place->second;
    if (is_new) {
      channel.id = static_cast<uint16_t>(channels_.size());
      const std::string schema = SchemaOf(message).dump();
      channel.schema =
          RecordOf(kMcapSchema, Pack(channel.id, type, "jsonschema", schema));
      channel.record = RecordOf(
          kMcapChannel, Pack(channel.id, channel.id, topic, "json", kNoText));
      chunk_ += channel.schema + channel.record;
    }
    channel.index += Pack(time, uint64_t{chunk_.size()});
    // The log time and the publish time are equal.
    chunk_ += RecordOf(
        kMcapMessage,
        Pack(channel.id, channel.messages++, time, time) + message.dump());
    if (chunk_.size() >= kMcapChunkSize) CloseChunk();
  }

  // Returns the bytes of the whole file. Must be called once, at the end.
  std::string Finish() {
    CloseChunk();
    file_ += RecordOf(kMcapDataEnd, Pack(McapChecksum(file_)));
    const uint64_t summary = file_.size();
    std::string schemas, channels, counts;
    for (const auto& [topic, channel] : channels_) {
      schemas += channel.schema;
      channels += channel.record;
      counts += Pack(channel.id, uint64_t{channel.messages});
    }
    const auto number = static_cast<uint16_t>(channels_.size());
    file_ += schemas + channels + chunk_indexes_ +
             RecordOf(kMcapStatistics,
                      Pack(messages_, number, uint32_t{number}, kNone, kNone,
                           chunks_, first_time_, last_time_, counts));
    // The footer is without summary offsets; the checksum of the summary is its
    // last field.
    const std::string footer =
        RecordOf(kMcapFooter, Pack(summary, uint64_t{0}, uint32_t{0}));
    file_.append(footer, 0, footer.size() - sizeof(uint32_t));
    file_ += Pack(McapChecksum(std::string_view(file_).substr(summary)));
    return std::move(file_ += kMcapMagic);
  }

 private:
  struct Channel {
    uint16_t id = 0;  // of the channel and of its schema
    std::string schema, record;
    uint32_t messages = 0;
    std::string index;  // of the messages in chunk_
  };

  void CloseChunk() {
    if (chunk_.empty()) return;
    const uint64_t start = file_.size(), size = chunk_.size();
    file_ += RecordOf(kMcapChunk, Pack(chunk_time_, last_time_, size,
                                       McapChecksum(chunk_), kNoText, size) +
                                      chunk_);
    const uint64_t end = file_.size();
    std::string places;
    for (auto& [topic, channel] : channels_) {
      if (channel.index.empty()) continue;
      places += Pack(channel.id, uint64_t{file_.size()});
      file_ += RecordOf(kMcapMessageIndex, Pack(channel.id, channel.index));
      channel.index.clear();
    }
    const uint64_t index_size = file_.size() - end;
    chunk_indexes_ += RecordOf(kMcapChunkIndex,
                               Pack(chunk_time_, last_time_, start, end - start,
                                    places, index_size, kNoText, size, size));
    ++chunks_;
    chunk_.clear();
  }

  std::string file_ =
      std::string(kMcapMagic) +
      RecordOf(kMcapHeader, Pack(kNoText, "rgbd_pose " RGBD_POSE_VERSION));
  std::string chunk_;                        // records not yet in file_
  std::map<std::string, Channel> channels_;  // by topic
  std::string chunk_indexes_;
  uint32_t chunks_ = 0;
  uint64_t messages_ = 0;
  uint64_t first_time_ = 0, chunk_time_ = 0, last_time_ = 0;  // ns
};

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
Trajectory KeyframesOf(const FinishedRun& run, const Trajectory& path) {
  if (run.folder.empty()) return {};
  const std::filesystem::path file =
      std::filesystem::path(run.folder) / "keyframes.csv";
  if (!std::filesystem::exists(file)) return {};
  const std::vector<double> column = CsvTable::Read(file).Numbers("timestamp");
  const std::set<double> times(column.begin(), column.end());
  Trajectory keyframes;
  for (const StampedPose& pose : path) {
    if (times.count(pose.timestamp) != 0) keyframes.push_back(pose);
  }
  return keyframes;
}

}  // namespace

std::string ExportMcap(const FinishedRun& run, const ExportOptions& options) {
  Trajectory path;
  for (size_t i = 0; i < run.segments.size(); ++i) {
    if (run.segments[i] == run.segments[0]) path.push_back(run.trajectory[i]);
  }
  if (path[0].timestamp < 0.0 ||
      path.back().timestamp > std::numeric_limits<uint32_t>::max()) {
    throw InputError((run.folder.empty() ? "" : "--run: " + run.folder + ": ") +
                     "Foxglove has times from 1970 to 2106; export the poses "
                     "with --to=tum");
  }
  RequireWritable(options.output);
  // Images are kept in memory, because the cloud, which needs all frames, comes
  // first.
  std::map<double, std::string> images;  // by time
  const ExportedViews views =
      ReadImages(run, options, [&](const Frame& frame, int view) {
        std::vector<uint8_t> jpeg;
        cv::imencode(".jpg", frame.color, jpeg, {cv::IMWRITE_JPEG_QUALITY, 90});
        images[run.trajectory[view].timestamp] = {jpeg.begin(), jpeg.end()};
      });

  McapWriter file;
  // Time stamps of trajectories have 6 decimals.
  constexpr uint64_t kMicro = 1000, kSecond = 1000000000;  // ns
  const auto write = [&file](const char* topic, const std::string& type,
                             double seconds, Json message) {
    const uint64_t time = kMicro * std::llround(1e6 * seconds);
    message["timestamp"] = {{"sec", time / kSecond}, {"nsec", time % kSecond}};
    file.Write(topic, "foxglove." + type, time, message);
  };
  const Rigid3d map_from_world({0.5, -0.5, 0.5, -0.5}, {0.0, 0.0, 0.0});
  const double start = path[0].timestamp;
  write("/tf_static", "FrameTransform", start,
        FrameTransform(kMap, kWorld, map_from_world));
  write("/path", "PosesInFrame", start, PosesInFrame(path));
  const Trajectory keyframes = KeyframesOf(run, path);
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
  std::string text =
      Format("%zu poses, %zu images, %zu points in %s\n", path.size(),
             images.size(), views.cloud.size(), options.output.c_str());
  if (path.size() < run.segments.size()) {
    text += Format(
        "%zu poses of other segments are left out: their position relative to "
        "the first segment is unknown\n",
        run.segments.size() - path.size());
  }
  return text;
}

}  // namespace rgbd_pose
