#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include "core/util/input_error.h"

// FUZZ_TARGET(NAME) { ... return 0; } defines a target: what is done with any
// `size` bytes at `data`. It is a program for libFuzzer or, in other builds,
// one of the targets of corpus_test.
#ifdef RGBD_POSE_BUILD_FUZZERS
#define FUZZ_TARGET(name) \
  extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size)
#else
#define FUZZ_TARGET(name)                                     \
  static int name##_target(const uint8_t* data, size_t size); \
  static const bool name##_is_added =                         \
      rgbd_pose::AddFuzzTarget(#name, &name##_target);        \
  static int name##_target(const uint8_t* data, size_t size)
#endif

namespace rgbd_pose {

// Makes a target known to corpus_test. Returns true.
bool AddFuzzTarget(const char* name, int (*target)(const uint8_t*, size_t));

inline std::string_view FuzzText(const uint8_t* data, size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Removes the part before the next line of four dashes from `rest` and returns
// it: one input may contain several files.
inline std::string_view NextFile(std::string_view* rest) {
  constexpr std::string_view kBetween = "----\n";
  const size_t end = rest->find(kBetween);
  const std::string_view file = rest->substr(0, end);
  rest->remove_prefix(end == std::string_view::npos ? rest->size()
                                                    : end + kBetween.size());
  return file;
}

// Reports an error found by the target, which ends it as a crash does.
inline void Require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "not as documented: %s\n", what);
  std::abort();
}

// Makes a call that may throw an InputError of one line, and nothing else.
template <typename Call>
void MayRefuse(Call call) {
  try {
    call();
  } catch (const InputError& error) {
    Require(std::string_view(error.what()).find('\n') == std::string::npos,
            "a message of one line");
  }
}

// A folder, in memory if the system has that, for parsers that read paths.
class FuzzFolder {
 public:
  FuzzFolder() {
    std::error_code error;
    const bool has_memory = std::filesystem::is_directory("/dev/shm", error);
    path_ = (has_memory ? std::filesystem::path("/dev/shm")
                        : std::filesystem::temp_directory_path()) /
            "rgbd_pose_fuzz.XXXXXX";
    Require(mkdtemp(path_.data()) != nullptr, "a folder to work in");
  }
  ~FuzzFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  FuzzFolder(const FuzzFolder&) = delete;
  FuzzFolder& operator=(const FuzzFolder&) = delete;

  const std::string& path() const { return path_; }

  // Writes a file, replacing any earlier one, and returns its path.
  std::string Write(const std::string& name, std::string_view bytes) const {
    const std::string path = path_ + "/" + name;
    std::FILE* file = std::fopen(path.c_str(), "wb");
    // fwrite() must not get a null pointer, even for 0 bytes.
    const bool is_written =
        file != nullptr &&
        (bytes.empty() ||
         std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size());
    Require(is_written && std::fclose(file) == 0, "a file that can be written");
    return path;
  }

 private:
  std::string path_;
};

}  // namespace rgbd_pose
