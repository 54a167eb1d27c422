#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/bags/bag_reader.h"
#include "frontend/bags/chunk_codec.h"
#include "frontend/bags/mcap_format.h"
#ifdef RGBD_POSE_HAS_LIBDEFLATE
#include <libdeflate.h>
#endif

namespace rgbd_pose {
namespace {

constexpr uint64_t kRecordHead = 9;  // opcode and length, bytes
constexpr uint64_t kFooterSize = 20;

struct McapChannel {
  std::string topic;
  std::string encoding;  // of the messages: cdr, ros1, ...
  std::string type;      // name of the schema
};

using McapChannels = std::map<uint16_t, McapChannel>;

struct McapMessage {
  uint16_t channel = 0;
  uint64_t log_time = 0;   // ns
  std::string_view bytes;  // valid until the next call of the reader
};

// Reads the messages of a file from its beginning, chunk by chunk, within a
// chunk in order of time. Throws InputError after the messages before a damage.
class McapRecords {
 public:
  explicit McapRecords(const std::string& path)
      : path_(path), file_(path, std::ios::binary | std::ios::ate) {
    if (!file_) throw InputError(path + ": cannot be read");
    size_ = static_cast<uint64_t>(file_.tellg());
    file_.seekg(0);
    std::string magic(kMcapMagic.size(), '\0');
    file_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
    if (magic != kMcapMagic) {
      throw InputError(path + (size_ == 0 ? ": is empty; copy it again"
                                          : ": is not an mcap file"));
    }
  }

  // The channels of the summary at the end of the file; none without one.
  // Nothing can be read after it.
  McapChannels ReadSummary() {
    const uint64_t tail = kRecordHead + kFooterSize + kMcapMagic.size();
    if (size_ < kMcapMagic.size() + tail) return {};
    file_.seekg(static_cast<std::streamoff>(size_ - tail));
    const std::optional<Record> footer = ReadRecord();
    if (!footer.has_value() || footer->opcode != kMcapFooter ||
        footer->content.size() != kFooterSize) {
      return {};
    }
    const auto start = WireReader(footer->content).Number<uint64_t>();
    if (start < kMcapMagic.size() || start >= size_ - tail) return {};
    file_.seekg(static_cast<std::streamoff>(start));
    while (const std::optional<Record> record = ReadRecord()) {
      if (record->opcode == kMcapFooter) break;
      if (record->opcode == kMcapSchema || record->opcode == kMcapChannel) {
        Located(path_, [&] { Take(record->opcode, record->content); });
      }
    }
    return channels_;
  }

  // The next message; nothing after the last one.
  std::optional<McapMessage> Next() {
    while (next_ == messages_.size()) {
      if (has_ended_) return std::nullopt;
      messages_.clear();
      next_ = 0;
      has_ended_ = true;  // unless the record is good
      std::optional<Record> record = ReadRecord();
      if (!record.has_value()) {
        is_cut_off_ = true;
        throw InputError(
            path_ +
            ": is cut off: the recording was not finished properly, or the "
            "copy is incomplete; run `mcap recover`");
      }
      if (record->opcode == kMcapDataEnd || record->opcode == kMcapFooter) {
        return std::nullopt;
      }
      Located(path_, [&] {
        if (record->opcode == kMcapChunk) {
          TakeChunk(record->content);
        } else {
          chunk_ = std::move(record->content);
          Take(record->opcode, chunk_);
        }
      });
      has_ended_ = false;
    }
    return messages_[next_++];
  }

  // Whether Next found that the file ends without its end record.
  bool is_cut_off() const { return is_cut_off_; }

  // The channels read so far.
  const McapChannels& channels() const { return channels_; }

 private:
  struct Record {
    uint8_t opcode = 0;
    std::string content;
  };

  // The next record of the file; nothing if the file ends within the record.
  std::optional<Record> ReadRecord() {
    const auto at = static_cast<uint64_t>(file_.tellg());
    char head[kRecordHead];
    if (size_ - at < kRecordHead || !file_.read(head, kRecordHead)) {
      return std::nullopt;
    }
    WireReader fields({head, kRecordHead});
    Record record;
    record.opcode = fields.Number<uint8_t>();
    const auto length = fields.Number<uint64_t>();
    if (length > size_ - at - kRecordHead) return std::nullopt;
    record.content.resize(length);
    file_.read(record.content.data(), static_cast<std::streamsize>(length));
    if (!file_) return std::nullopt;
    return record;
  }

  // Parses a schema, channel or message record and stores the result.
  void Take(uint8_t opcode, std::string_view content) {
    WireReader fields(content);
    if (opcode == kMcapSchema) {
      const auto id = fields.Number<uint16_t>();
      schemas_[id] = fields.Text();
    } else if (opcode == kMcapChannel) {
      const auto id = fields.Number<uint16_t>();
      const auto schema = fields.Number<uint16_t>();
      McapChannel& channel = channels_[id];
      channel.topic = fields.Text();
      channel.encoding = fields.Text();
      channel.type = schemas_[schema];
    } else if (opcode == kMcapMessage) {
      McapMessage message;
      message.channel = fields.Number<uint16_t>();
      fields.Number<uint32_t>();  // sequence number
      message.log_time = fields.Number<uint64_t>();
      fields.Number<uint64_t>();  // publish time
      message.bytes = fields.rest();
      if (channels_.count(message.channel) == 0) {
        throw Damaged("a message has no channel");
      }
      messages_.push_back(message);
    }
  }

  void TakeChunk(std::string_view content) {
    WireReader chunk(content);
    chunk.Take(2 * sizeof(uint64_t));  // times of the first and last message
    const auto size = chunk.Number<uint64_t>();
    const auto checksum = chunk.Number<uint32_t>();
    const std::string_view codec = chunk.Text();
    const std::string_view packed = chunk.Take(chunk.Number<uint64_t>());
    chunk_ = Unpack(packed, codec, size);
    // 0: the file or this build has no checksums.
    const uint32_t expected = checksum == 0 ? 0 : McapChecksum(chunk_);
    if (expected != 0 && expected != checksum) {
      throw Damaged("a chunk does not match its checksum");
    }
    WireReader records(chunk_);
    while (!records.rest().empty()) {
      const auto opcode = records.Number<uint8_t>();
      Take(opcode, records.Take(records.Number<uint64_t>()));
    }
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const McapMessage& a, const McapMessage& b) {
                       return a.log_time < b.log_time;
                     });
  }

  std::string path_;
  std::ifstream file_;
  uint64_t size_ = 0;
  bool has_ended_ = false;
  bool is_cut_off_ = false;
  std::map<uint16_t, std::string> schemas_;  // type names by schema id
  McapChannels channels_;
  std::string chunk_;                  // the memory that messages_ point into
  std::vector<McapMessage> messages_;  // of chunk_, in order of time
  size_t next_ = 0;
};

class McapFile final : public BagReader {
 public:
  explicit McapFile(const std::string& path)
      : BagReader(path, WireFormat::kCdr) {
    const McapChannels channels = FindChannels(path);
    const bool is_ros2 = std::any_of(
        channels.begin(), channels.end(),
        [](const auto& row) { return row.second.encoding == "cdr"; });
    format_ = is_ros2 ? WireFormat::kCdr : WireFormat::kRos1;
    std::set<std::string> others;  // encodings
    for (const auto& [number, channel] : channels) {
      if (channel.encoding != (is_ros2 ? "cdr" : "ros1")) {
        others.insert(channel.encoding);
        continue;
      }
      AddTopic(number, channel.topic, channel.type);
    }
    if (topics_.empty() && !others.empty()) {
      throw InputError(path + ": has messages encoded as " +
                       Join({others.begin(), others.end()}) +
                       "; only those of ROS (cdr, ros1) are supported");
    }
  }

  std::vector<BagMessage> First(const std::string& topic, int count) override {
    std::vector<BagMessage> first;
    McapRecords records(path_);
    const std::set<int64_t> channels = NumbersOf({topic});
    try {
      while (static_cast<int>(first.size()) < count) {
        std::optional<BagMessage> message = NextOf(&records, channels);
        if (!message.has_value()) break;
        first.push_back(*std::move(message));
      }
    } catch (const InputError&) {
      // Unless rethrown here, Next reports the error when it reaches it.
      if (first.empty() && !records.is_cut_off()) throw;
    }
    return first;
  }

 private:
  // The channels of the summary. Without one the whole file is read once.
  static McapChannels FindChannels(const std::string& path) {
    McapChannels summary = McapRecords(path).ReadSummary();
    if (!summary.empty()) return summary;
    McapRecords records(path);
    try {
      while (records.Next().has_value()) continue;
    } catch (const InputError&) {
      if (records.channels().empty()) throw;
    }
    return records.channels();
  }

  Messages MessagesOf(const std::vector<std::string>& topics) override {
    const auto records = std::make_shared<McapRecords>(path_);
    return [this, records, channels = NumbersOf(topics)] {
      return NextOf(records.get(), channels);
    };
  }

  std::optional<BagMessage> NextOf(McapRecords* records,
                                   const std::set<int64_t>& channels) const {
    while (const std::optional<McapMessage> message = records->Next()) {
      if (channels.count(message->channel) == 0) continue;
      return BagMessage{names_.at(message->channel), 1e-9 * message->log_time,
                        std::make_shared<std::string>(message->bytes)};
    }
    return std::nullopt;
  }
};

}  // namespace

uint32_t McapChecksum([[maybe_unused]] std::string_view bytes,
                      [[maybe_unused]] uint32_t before) {
#ifdef RGBD_POSE_HAS_LIBDEFLATE
  return libdeflate_crc32(before, bytes.data(), bytes.size());
#else
  return 0;
#endif
}

std::unique_ptr<BagReader> OpenMcapFile(const std::string& path) {
  return std::make_unique<McapFile>(path);
}

}  // namespace rgbd_pose
