#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace rgbd_pose {

// Puts an mcap file (mcap.dev/spec) of JSON messages together: in chunks that
// are not packed, with schemas, indexes, statistics and checksums.
class McapWriter {
 public:
  McapWriter();

  // `type`: name of the message's schema, one a topic. The schema itself is
  // that of the first message, whose lists must not be empty; text named "data"
  // counts as bytes in base64, as in all types of Foxglove. Times (ns) must not
  // decrease.
  void Write(const std::string& topic, const std::string& type, uint64_t time,
             const nlohmann::json& message);

  // The bytes of the whole file; to be called once, at the end.
  std::string Finish();

 private:
  struct Channel {
    uint16_t id = 0;  // that of its schema, too
    std::string schema, record;
    uint32_t messages = 0;
    std::string index;  // of those in chunk_
  };

  void CloseChunk();

  std::string file_;
  std::string chunk_;                        // what is not in file_ yet
  std::map<std::string, Channel> channels_;  // by topic
  std::string chunk_indexes_;
  uint32_t chunks_ = 0;
  uint64_t messages_ = 0;
  uint64_t first_time_ = 0, chunk_time_ = 0, last_time_ = 0;  // ns
};

}  // namespace rgbd_pose
