#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "core/util/input_error.h"

namespace rgbd_pose {

// The error for a file, or a part of a file, that is not as it was written.
inline InputError Damaged(const std::string& what) {
  return InputError(what + "; it is damaged: copy it again");
}

// Binary layout of the messages of a bag. Both have the same fields in the same
// order, but differ in padding, string terminators and the header's counter.
enum class WireFormat {
  kRos1,  // numbers without padding
  kCdr,   // ROS 2: each number is aligned to a multiple of its size
};

// Reads values from the bytes of a message, one after the other. All calls
// throw InputError if the message ends before the value does. Returned views
// point into the message, which must outlive them.
class WireReader {
 public:
  // Throws InputError for a kind of CDR that ROS 2 does not write.
  explicit WireReader(std::string_view message,
                      WireFormat format = WireFormat::kRos1);

  WireFormat format() const { return format_; }

  // The bytes not read yet.
  std::string_view rest() const { return rest_; }

  std::string_view Take(size_t size);

  // An integer or floating-point number of 1, 2, 4 or 8 bytes.
  template <typename T>
  T Number() {
    T value;
    ReadNumber(&value, sizeof(T));
    return value;
  }

  // A string without its terminator.
  std::string_view Text();

  // A byte array.
  std::string_view Bytes();

  // The length of the list that follows. Also throws if the rest of the message
  // is too short for that many elements of at least `least_bytes` each.
  uint32_t Count(size_t least_bytes);

 private:
  void ReadNumber(void* value, size_t size);

  std::string_view rest_;
  size_t place_ = 0;  // offset of rest_ after any CDR header, bytes
  WireFormat format_;
  bool swaps_ = false;  // whether the bytes of numbers must be swapped
};

}  // namespace rgbd_pose
