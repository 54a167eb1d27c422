#include "apps/export/mcap_writer.h"

#include <string_view>
#include <type_traits>
#include <utility>

#include "core/util/format.h"
#include "frontend/bags/mcap_format.h"

namespace rgbd_pose {
namespace {

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

}  // namespace

McapWriter::McapWriter()
    : bytes_(std::string(kMcapMagic) +
             RecordOf(kMcapHeader,
                      Pack("ros2", "rgbd_pose " RGBD_POSE_VERSION))) {}

void McapWriter::AddTopic(const std::string& topic, const McapSchema& schema) {
  Channel& channel = channels_[topic];
  channel.id = static_cast<uint16_t>(channels_.size());
  channel.schema = RecordOf(
      kMcapSchema, Pack(channel.id, schema.type, "ros2msg", schema.text));
  channel.record = RecordOf(
      kMcapChannel, Pack(channel.id, channel.id, topic, "cdr", kNoText));
}

void McapWriter::Write(const std::string& topic, uint64_t time,
                       const std::string& message) {
  if (messages_++ == 0) first_time_ = time;
  if (chunk_.empty()) chunk_time_ = time;
  last_time_ = time;
  Channel& channel = channels_.at(topic);
  if (channel.messages == 0) chunk_ += channel.schema + channel.record;
  channel.index += Pack(time, uint64_t{chunk_.size()});
  // The log time and the publish time are equal.
  chunk_ += RecordOf(
      kMcapMessage, Pack(channel.id, channel.messages++, time, time) + message);
  if (chunk_.size() >= kMcapChunkSize) CloseChunk();
}

std::string McapWriter::Take() {
  taken_ += bytes_.size();
  checksum_ = McapChecksum(bytes_, checksum_);
  return std::exchange(bytes_, "");
}

std::string McapWriter::Finish() {
  CloseChunk();
  bytes_ += RecordOf(kMcapDataEnd, Pack(McapChecksum(bytes_, checksum_)));
  const size_t summary = bytes_.size();
  std::string schemas, channels, counts;
  for (const auto& [topic, channel] : channels_) {
    schemas += channel.schema;
    channels += channel.record;
    counts += Pack(channel.id, uint64_t{channel.messages});
  }
  const auto number = static_cast<uint16_t>(channels_.size());
  bytes_ += schemas + channels + chunk_indexes_ +
            RecordOf(kMcapStatistics,
                     Pack(messages_, number, uint32_t{number}, kNone, kNone,
                          chunks_, first_time_, last_time_, counts));
  // The footer is without summary offsets; the checksum of the summary is its
  // last field.
  const std::string footer =
      RecordOf(kMcapFooter, Pack(taken_ + summary, uint64_t{0}, uint32_t{0}));
  bytes_.append(footer, 0, footer.size() - sizeof(uint32_t));
  bytes_ += Pack(McapChecksum(std::string_view(bytes_).substr(summary)));
  return std::move(bytes_ += kMcapMagic);
}

void McapWriter::CloseChunk() {
  if (chunk_.empty()) return;
  const uint64_t start = taken_ + bytes_.size(), size = chunk_.size();
  bytes_ += RecordOf(kMcapChunk, Pack(chunk_time_, last_time_, size,
                                      McapChecksum(chunk_), kNoText, size) +
                                     chunk_);
  const uint64_t end = taken_ + bytes_.size();
  std::string places;
  for (auto& [topic, channel] : channels_) {
    if (channel.index.empty()) continue;
    places += Pack(channel.id, taken_ + bytes_.size());
    bytes_ += RecordOf(kMcapMessageIndex, Pack(channel.id, channel.index));
    channel.index.clear();
  }
  const uint64_t index_size = taken_ + bytes_.size() - end;
  chunk_indexes_ += RecordOf(
      kMcapChunkIndex, Pack(chunk_time_, last_time_, start, end - start, places,
                            index_size, kNoText, size, size));
  ++chunks_;
  chunk_.clear();
}

}  // namespace rgbd_pose
