#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace rgbd_pose {

// Builds an mcap file (mcap.dev/spec) of JSON messages, with uncompressed
// chunks, schemas, indexes, statistics and checksums.
class McapWriter {
 public:
  McapWriter();

  // Appends a message. `type` is the name of the topic's schema. The schema
  // itself is derived from the first message, whose lists must not be empty;
  // text named "data" is declared as base64, as in all Foxglove types. Times
  // (ns) must not decrease.
  void Write(const std::string& topic, const std::string& type, uint64_t time,
             const nlohmann::json& message);

  // Returns the bytes of the whole file. Must be called once, at the end.
  std::string Finish();

 private:
  struct Channel {
    uint16_t id = 0;  // of the channel and of its schema
    std::string schema, record;
    uint32_t messages = 0;
    std::string index;  // of the messages in chunk_
  };

  void CloseChunk();

  std::string file_;
  std::string chunk_;                        // records not yet in file_
  std::map<std::string, Channel> channels_;  // by topic
  std::string chunk_indexes_;
  uint32_t chunks_ = 0;
  uint64_t messages_ = 0;
  uint64_t first_time_ = 0, chunk_time_ = 0, last_time_ = 0;  // ns
};

}  // namespace rgbd_pose
