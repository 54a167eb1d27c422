#pragma once

#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rgbd_pose {

// The records of an mcap file (mcap.dev/spec), as far as messages take them.

// Where the messages of a channel belong.
struct McapChannel {
  std::string topic;
  std::string encoding;  // of its messages: cdr, ros1, ...
  std::string type;      // of them, as in its schema
};

// Channels by their number.
using McapChannels = std::map<uint16_t, McapChannel>;

struct McapMessage {
  uint16_t channel = 0;
  uint64_t log_time = 0;   // ns
  std::string_view bytes;  // of the reader's chunk: good until its next call
};

// Reads the messages of a file from its beginning: chunk by chunk, in each by
// time. Needs neither index nor summary. Calls throw InputError where the file
// is damaged or cut off, once what came before has been given.
class McapRecords {
 public:
  explicit McapRecords(const std::string& path);

  // Those of the summary at the file's end; nothing: there is none.
  std::optional<McapChannels> ReadSummary();

  // The next message; nothing after the last one.
  std::optional<McapMessage> Next();

  // Whether the file ends before its end mark, as Next has said.
  bool is_cut_off() const { return is_cut_off_; }

  // Those met so far.
  const McapChannels& channels() const { return channels_; }

 private:
  struct Record {
    uint8_t opcode = 0;
    std::string content;
  };

  [[noreturn]] void Fail(const std::string& what);
  // The next record of the file; nothing: it ends in the middle of one.
  std::optional<Record> ReadRecord();
  // Takes schemas and channels in, and messages into messages_.
  void Take(uint8_t opcode, std::string_view content);
  void TakeChunk(std::string_view content);

  std::string path_;
  std::ifstream file_;
  uint64_t size_ = 0;
  bool has_ended_ = false;
  bool is_cut_off_ = false;
  std::map<uint16_t, std::string> schemas_;  // their types
  McapChannels channels_;
  std::string chunk_;                  // what messages_ lie in
  std::vector<McapMessage> messages_;  // of it, by time
  size_t next_ = 0;
};

}  // namespace rgbd_pose
