#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/util/input_error.h"

namespace rgbd_pose {

// Of a file, or a part of it, that is not as it was written.
inline InputError Damaged(const std::string& what) {
  return InputError(what + "; it is damaged: copy it again");
}

// How the messages of a bag are laid out: the same fields in the same order,
// but for padding, the ends of texts and the header's counter.
enum class WireFormat {
  kRos1,  // numbers one after the other
  kCdr,   // ROS 2: each at a multiple of its size
};

// Takes values off the bytes of a message, one after the other. All throw
// InputError where the message ends before the value does; what is text or
// bytes stays where it is: the message must outlive it.
class WireReader {
 public:
  // Throws InputError for CDR of a kind that ROS 2 does not write.
  WireReader(std::string_view message, WireFormat format);

  WireFormat format() const { return format_; }

  // What has not been taken.
  std::string_view rest() const { return rest_; }

  // So many bytes.
  std::string_view Take(size_t size);

  // A whole or floating-point number of 1, 2, 4 or 8 bytes.
  template <typename T>
  T Number() {
    T value;
    ReadNumber(&value, sizeof(T));
    return value;
  }

  // A text without its end mark.
  std::string_view Text();

  // A list of bytes.
  std::string_view Bytes();

  // How many there are in the list that follows. Throws, too, for more than
  // can be if each takes `least_bytes` at least.
  uint32_t Count(size_t least_bytes);

 private:
  void ReadNumber(void* value, size_t size);

  std::string_view rest_;
  size_t place_ = 0;  // of rest_, where CDR counts from
  WireFormat format_;
  bool swaps_ = false;  // the bytes of a number
};

}  // namespace rgbd_pose
