#include "frontend/bags/mcap_records.h"

#ifdef RGBD_POSE_HAS_LIBDEFLATE
#include <libdeflate.h>
#endif

#include <algorithm>
#include <cstring>
#include <utility>

#include "core/util/input_error.h"
#include "frontend/bags/chunk_codec.h"
#include "frontend/bags/wire_reader.h"

namespace rgbd_pose {
namespace {

constexpr std::string_view kMagic = "\x89MCAP0\r\n";
constexpr uint64_t kRecordHead = 9;  // bytes: opcode and length
constexpr uint64_t kFooterSize = 20;

enum Opcode : uint8_t {
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kDataEnd = 0x0f,
};

// CRC-32; 0: the recorder made none. Without libdeflate all pass.
bool IsChecksumOf([[maybe_unused]] std::string_view bytes,
                  [[maybe_unused]] uint32_t checksum) {
#ifdef RGBD_POSE_HAS_LIBDEFLATE
  return checksum == 0 ||
         libdeflate_crc32(0, bytes.data(), bytes.size()) == checksum;
#else
  return true;
#endif
}

}  // namespace

McapRecords::McapRecords(const std::string& path)
    : path_(path), file_(path, std::ios::binary | std::ios::ate) {
  if (!file_) throw InputError(path + ": cannot be read");
  size_ = static_cast<uint64_t>(file_.tellg());
  file_.seekg(0);
  std::string magic(kMagic.size(), '\0');
  file_.read(magic.data(), static_cast<std::streamsize>(magic.size()));
  if (magic != kMagic) {
    throw InputError(path + (size_ == 0 ? ": is empty; copy it again"
                                        : ": is no mcap file"));
  }
}

void McapRecords::Fail(const std::string& what) {
  has_ended_ = true;
  throw InputError(path_ + ": " + what);
}

std::optional<McapRecords::Record> McapRecords::ReadRecord() {
  const auto at = static_cast<uint64_t>(file_.tellg());
  char head[kRecordHead];
  if (size_ - at < kRecordHead || !file_.read(head, kRecordHead)) {
    return std::nullopt;
  }
  WireReader fields({head, kRecordHead}, WireFormat::kRos1);
  Record record;
  record.opcode = fields.Number<uint8_t>();
  const auto length = fields.Number<uint64_t>();
  if (length > size_ - at - kRecordHead) return std::nullopt;
  record.content.resize(length);
  file_.read(record.content.data(), static_cast<std::streamsize>(length));
  if (!file_) return std::nullopt;
  return record;
}

std::optional<McapChannels> McapRecords::ReadSummary() {
  const uint64_t tail = kRecordHead + kFooterSize + kMagic.size();
  if (size_ < kMagic.size() + tail) return std::nullopt;
  const std::streampos before = file_.tellg();
  file_.seekg(static_cast<std::streamoff>(size_ - tail));
  const std::optional<Record> footer = ReadRecord();
  uint64_t start = 0;
  if (footer && footer->opcode == kFooter &&
      footer->content.size() == kFooterSize) {
    start = WireReader(footer->content, WireFormat::kRos1).Number<uint64_t>();
  }
  if (start >= kMagic.size() && start < size_ - tail) {
    file_.seekg(static_cast<std::streamoff>(start));
    while (const std::optional<Record> record = ReadRecord()) {
      if (record->opcode == kFooter) break;
      if (record->opcode == kSchema || record->opcode == kChannel) {
        Take(record->opcode, record->content);
      }
    }
  }
  file_.clear();
  file_.seekg(before);
  if (channels_.empty()) return std::nullopt;
  return channels_;
}

std::optional<McapMessage> McapRecords::Next() {
  while (next_ == messages_.size()) {
    if (has_ended_) return std::nullopt;
    messages_.clear();
    next_ = 0;
    std::optional<Record> record = ReadRecord();
    if (!record.has_value()) {
      is_cut_off_ = true;
      Fail(
          "is cut off: its recorder was not ended properly, or it was copied "
          "in part; `mcap recover` makes a whole one of what there is");
    }
    if (record->opcode == kDataEnd || record->opcode == kFooter) {
      has_ended_ = true;
      return std::nullopt;
    }
    try {
      if (record->opcode == kChunk) {
        TakeChunk(record->content);
      } else if (record->opcode == kMessage) {
        chunk_ = std::move(record->content);
        Take(kMessage, chunk_);
      } else {
        Take(record->opcode, record->content);
      }
    } catch (const InputError& error) {
      Fail(error.what());
    }
  }
  return messages_[next_++];
}

void McapRecords::Take(uint8_t opcode, std::string_view content) {
  WireReader fields(content, WireFormat::kRos1);
  if (opcode == kSchema) {
    const auto id = fields.Number<uint16_t>();
    schemas_[id] = fields.Text();
  } else if (opcode == kChannel) {
    const auto id = fields.Number<uint16_t>();
    const auto schema = fields.Number<uint16_t>();
    McapChannel& channel = channels_[id];
    channel.topic = fields.Text();
    channel.encoding = fields.Text();
    channel.type = schemas_[schema];
  } else if (opcode == kMessage) {
    McapMessage message;
    message.channel = fields.Number<uint16_t>();
    fields.Number<uint32_t>();  // its place in the channel
    message.log_time = fields.Number<uint64_t>();
    fields.Number<uint64_t>();  // when it was published
    message.bytes = fields.rest();
    if (channels_.count(message.channel) == 0) {
      throw InputError(std::string("a message is of no channel") + kDamaged);
    }
    messages_.push_back(message);
  }
}

void McapRecords::TakeChunk(std::string_view content) {
  WireReader chunk(content, WireFormat::kRos1);
  chunk.Take(2 * sizeof(uint64_t));  // times of its first and last message
  const auto size = chunk.Number<uint64_t>();
  const auto checksum = chunk.Number<uint32_t>();
  const std::string_view codec = chunk.Text();
  const std::string_view packed = chunk.Take(chunk.Number<uint64_t>());
  chunk_ = Unpack(packed, codec, size);
  if (!IsChecksumOf(chunk_, checksum)) {
    throw InputError(std::string("a chunk is not what its checksum says") +
                     kDamaged);
  }
  WireReader records(chunk_, WireFormat::kRos1);
  while (!records.rest().empty()) {
    const auto opcode = records.Number<uint8_t>();
    Take(opcode, records.Take(records.Number<uint64_t>()));
  }
  std::stable_sort(messages_.begin(), messages_.end(),
                   [](const McapMessage& a, const McapMessage& b) {
                     return a.log_time < b.log_time;
                   });
}

}  // namespace rgbd_pose
