#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace rgbd_pose {

// How the messages of a topic are to be read.
struct McapSchema {
  std::string type;  // its name
  std::string text;  // its definition (ros2msg)
};

// Builds an mcap file (mcap.dev/spec) of messages of ROS 2 in CDR, with
// uncompressed chunks, schemas, indexes, statistics and checksums.
class McapWriter {
 public:
  McapWriter();

  bool HasTopic(const std::string& topic) const {
    return channels_.count(topic) != 0;
  }
  void AddTopic(const std::string& topic, const McapSchema& schema);

  // Appends a message of a topic that was added. Times (ns) must not decrease.
  void Write(const std::string& topic, uint64_t time,
             const std::string& message);

  // The bytes of the file so far, as far as they are final, and not those that
  // an earlier call returned: for files that are written piece by piece.
  std::string Take();

  // Returns the rest of the bytes: without Take, of the whole file. Must be
  // called once, at the end.
  std::string Finish();

 private:
  struct Channel {
    uint16_t id = 0;  // of the channel and of its schema
    std::string schema, record;
    uint32_t messages = 0;
    std::string index;  // of the messages in chunk_
  };

  void CloseChunk();

  std::string bytes_;                        // of the file, not yet taken
  uint64_t taken_ = 0;                       // number of bytes
  uint32_t checksum_ = 0;                    // of these
  std::string chunk_;                        // records not yet in bytes_
  std::map<std::string, Channel> channels_;  // by topic
  std::string chunk_indexes_;
  uint32_t chunks_ = 0;
  uint64_t messages_ = 0;
  uint64_t first_time_ = 0, chunk_time_ = 0, last_time_ = 0;  // ns
};

}  // namespace rgbd_pose
