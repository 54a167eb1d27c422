#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <utility>

#include "core/util/input_error.h"
#include "frontend/bags/bag_reader.h"
#include "frontend/bags/chunk_codec.h"

// http://wiki.ros.org/Bags/Format/2.0: a record has a header, which consists of
// fields NAME=VALUE, and data. Each of them follows its length.

namespace rgbd_pose {
namespace {

constexpr std::string_view kRos1Version = "#ROSBAG V2.0\n";

enum Ros1Op : uint8_t {
  kMessageData = 0x02,
  kIndexData = 0x04,
  kChunk = 0x05,
  kChunkInfo = 0x06,
  kConnection = 0x07,
};

// The value of a header field; empty if the header has no such field.
std::string_view Field(std::string_view header, std::string_view name) {
  WireReader fields(header);
  while (!fields.rest().empty()) {
    const std::string_view field = fields.Bytes();
    if (field.size() > name.size() && field[name.size()] == '=' &&
        field.substr(0, name.size()) == name) {
      return field.substr(name.size() + 1);
    }
  }
  return {};
}

template <typename T>
T NumberField(std::string_view header, std::string_view name) {
  return WireReader(Field(header, name)).Number<T>();
}

// The next time, ns.
uint64_t ReadTime(WireReader* reader) {
  const uint64_t seconds = reader->Number<uint32_t>();
  return seconds * 1'000'000'000 + reader->Number<uint32_t>();
}

uint64_t TimeField(std::string_view header, std::string_view name) {
  WireReader time(Field(header, name));
  return ReadTime(&time);
}

class Ros1Bag final : public BagReader {
 public:
  explicit Ros1Bag(const std::string& path)
      : BagReader(path, WireFormat::kRos1),
        file_(path, std::ios::binary | std::ios::ate) {
    const std::streamoff size = file_.tellg();
    if (size < 0) throw InputError(path + ": cannot be read");
    if (size == 0) throw InputError(path + ": is empty; copy it again");
    size_ = static_cast<uint64_t>(size);
    file_.seekg(0);
    std::string version(kRos1Version.size(), '\0');
    file_.read(version.data(), static_cast<std::streamsize>(version.size()));
    if (version != kRos1Version) {
      throw InputError(path + ": is not a ROS 1 bag (of format 2.0)");
    }
    std::string header;
    uint64_t index = 0;
    Guarded([&] {
      header = ReadBlock();
      index = NumberField<uint64_t>(header, "index_pos");
    });
    if (!Field(header, "encryptor").empty()) {
      throw InputError(path + ": is encrypted; run `rosbag decrypt`");
    }
    is_unfinished_ = index == 0 || index > size_;
    Guarded([&] { is_unfinished_ ? ReadChunks() : ReadIndex(index); });
    std::stable_sort(
        chunks_.begin(), chunks_.end(),
        [](const Chunk& a, const Chunk& b) { return a.start < b.start; });
  }

  // The end of an unfinished bag concerns only those who read up to it.
  std::vector<BagMessage> First(const std::string& topic, int count) override {
    return Take(Read({topic}), count);
  }

 private:
  struct Chunk {
    uint64_t place = 0;  // offset in the file, bytes
    uint64_t start = 0;  // time of the first message, ns
    std::vector<uint32_t> connections;
  };

  using MessagesByTime = std::multimap<uint64_t, BagMessage>;

  // Runs `call`, which parses parts of the file, and adds advice to its errors.
  template <typename Call>
  void Guarded(Call call) const {
    Located(path_, call, ", or try `rosbag reindex`");
  }

  // Reads a header or data at the current position of the file.
  std::string ReadBlock() {
    char head[sizeof(uint32_t)];
    file_.read(head, sizeof(head));
    const auto length = WireReader({head, sizeof(head)}).Number<uint32_t>();
    if (!file_ || length > size_ - static_cast<uint64_t>(file_.tellg())) {
      file_.clear();
      throw Damaged("a record ends too early");
    }
    std::string block(length, '\0');
    file_.read(block.data(), length);
    return block;
  }

  void ReadIndex(uint64_t index) {
    file_.seekg(static_cast<std::streamoff>(std::min(index, size_)));
    while (static_cast<uint64_t>(file_.tellg()) < size_) {
      const std::string header = ReadBlock();
      const std::string data = ReadBlock();
      const auto op = NumberField<uint8_t>(header, "op");
      if (op == kConnection) {
        AddConnection(header, data);
      } else if (op == kChunkInfo) {
        Chunk chunk;
        chunk.place = NumberField<uint64_t>(header, "chunk_pos");
        chunk.start = TimeField(header, "start_time");
        WireReader counts(data);
        while (!counts.rest().empty()) {
          chunk.connections.push_back(counts.Number<uint32_t>());
          if (names_.count(chunk.connections.back()) == 0) {
            throw Damaged("a chunk has messages without a topic");
          }
          counts.Number<uint32_t>();
        }
        chunks_.push_back(std::move(chunk));
      }
    }
  }

  // Reads a file without an index: after each chunk follow the times of its
  // messages; connections are in the chunk of their first message.
  void ReadChunks() {
    ReadBlock();  // padding of the bag's header
    while (static_cast<uint64_t>(file_.tellg()) < size_) {
      const auto place = static_cast<uint64_t>(file_.tellg());
      std::string header, data;
      uint8_t op = 0;
      try {
        header = ReadBlock();
        data = ReadBlock();
        op = NumberField<uint8_t>(header, "op");
      } catch (const InputError&) {
        break;  // cut off within this record, or filled with zeros from here
      }
      if (op == kChunk) chunks_.push_back({place, UINT64_MAX, {}});
      if (op != kIndexData || chunks_.empty()) continue;
      Chunk& chunk = chunks_.back();
      chunk.connections.push_back(NumberField<uint32_t>(header, "conn"));
      WireReader index(data);
      while (!index.rest().empty()) {
        chunk.start = std::min(chunk.start, ReadTime(&index));
        index.Number<uint32_t>();  // the place in the chunk
      }
      if (names_.count(chunk.connections.back()) > 0) continue;
      const std::streampos next = file_.tellg();
      Load(chunk);
      loaded_ = nullptr;  // more chunks will move this one in memory
      WireReader records(records_);
      while (!records.rest().empty()) {
        const std::string_view of = records.Bytes();
        const std::string_view content = records.Bytes();
        if (NumberField<uint8_t>(of, "op") == kConnection) {
          AddConnection(of, content);
        }
      }
      if (names_.count(chunk.connections.back()) == 0) {
        throw Damaged("a chunk has messages without a topic");
      }
      file_.seekg(next);
    }
    if (topics_.empty()) {
      throw InputError("ends before its first messages: copy it again");
    }
  }

  void AddConnection(std::string_view header, std::string_view data) {
    AddTopic(NumberField<uint32_t>(header, "conn"),
             std::string(Field(header, "topic")),
             std::string(Field(data, "type")));
  }

  Messages MessagesOf(const std::vector<std::string>& topics) override {
    return [this, next = Read(topics), has_ended = false]() mutable {
      std::optional<BagMessage> message;
      if (!has_ended) message = next();
      if (!message.has_value() && is_unfinished_ && !has_ended) {
        has_ended = true;
        throw InputError(path_ +
                         ": ends without its index: the recording was not "
                         "finished properly, or the copy is incomplete; run "
                         "`rosbag reindex`");
      }
      return message;
    };
  }

  // A chunk is loaded when the time of its first message is reached; its
  // messages are then kept in `waiting`.
  Messages Read(const std::vector<std::string>& topics) {
    return [this, connections = NumbersOf(topics), next = size_t{0},
            waiting = MessagesByTime()]() mutable -> std::optional<BagMessage> {
      while (
          next < chunks_.size() &&
          (waiting.empty() || chunks_[next].start <= waiting.begin()->first)) {
        const Chunk& chunk = chunks_[next++];
        if (std::any_of(
                chunk.connections.begin(), chunk.connections.end(),
                [&](uint32_t of) { return connections.count(of) > 0; })) {
          Load(chunk);
          Guarded([&] { TakeMessages(connections, &waiting); });
        }
      }
      if (waiting.empty()) return std::nullopt;
      return std::move(waiting.extract(waiting.begin()).mapped());
    };
  }

  void Load(const Chunk& chunk) {
    if (loaded_ == &chunk) return;
    loaded_ = nullptr;
    std::string header, packed;
    std::string_view codec;
    uint32_t size = 0;
    Guarded([&] {
      file_.seekg(static_cast<std::streamoff>(std::min(chunk.place, size_)));
      header = ReadBlock();
      packed = ReadBlock();
      size = NumberField<uint32_t>(header, "size");
      codec = Field(header, "compression");
    });
    records_ = Located(path_, [&] {
      return Unpack(packed, codec == "none" ? "" : codec, size);
    });
    loaded_ = &chunk;
  }

  // Puts the messages of the loaded chunk into `waiting`.
  void TakeMessages(const std::set<int64_t>& connections,
                    MessagesByTime* waiting) const {
    WireReader records(records_);
    while (!records.rest().empty()) {
      const std::string_view header = records.Bytes();
      const std::string_view data = records.Bytes();
      if (NumberField<uint8_t>(header, "op") != kMessageData) continue;
      const auto connection = NumberField<uint32_t>(header, "conn");
      if (connections.count(connection) == 0) continue;
      const uint64_t time = TimeField(header, "time");
      waiting->emplace(time, BagMessage{names_.at(connection), 1e-9 * time,
                                        std::make_shared<std::string>(data)});
    }
  }

  std::ifstream file_;
  uint64_t size_ = 0;
  bool is_unfinished_ = false;
  std::vector<Chunk> chunks_;  // in order of time
  const Chunk* loaded_ = nullptr;
  std::string records_;  // of the loaded chunk
};

}  // namespace

std::unique_ptr<BagReader> OpenRos1Bag(const std::string& path) {
  return std::make_unique<Ros1Bag>(path);
}

}  // namespace rgbd_pose
