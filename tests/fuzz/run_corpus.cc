// Replaces libFuzzer, with any compiler: passes each file of the given folders
// to the target once.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <vector>

#include "core/util/text_file.h"
#include "tests/fuzz/fuzz_input.h"

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  for (int i = 1; i < argc; ++i) {
    for (const auto& entry : fs::directory_iterator(argv[i])) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    std::printf("%s\n", file.c_str());
    std::fflush(stdout);  // the last line names the file of a crash
    const std::string bytes = rgbd_pose::ReadTextFile(file.string());
    // A copy of exactly this size: a memory checker finds reads past its end.
    const std::vector<uint8_t> copy(bytes.begin(), bytes.end());
    LLVMFuzzerTestOneInput(copy.data(), copy.size());
  }
  return files.empty() ? 1 : 0;
}
