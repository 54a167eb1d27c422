// corpus_test NAME FOLDER: replaces libFuzzer, with any compiler. Passes each
// file of the folder to a target once.

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <vector>

#include "core/util/text_file.h"
#include "tests/fuzz/fuzz_input.h"

namespace rgbd_pose {
namespace {

using FuzzTarget = int (*)(const uint8_t*, size_t);

std::map<std::string, FuzzTarget>& Targets() {
  static std::map<std::string, FuzzTarget> targets;
  return targets;
}

}  // namespace

bool AddFuzzTarget(const char* name, FuzzTarget target) {
  return Targets().emplace(name, target).second;
}

}  // namespace rgbd_pose

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  if (argc != 3 || rgbd_pose::Targets().count(argv[1]) == 0) {
    std::fprintf(stderr, "usage: corpus_test NAME_OF_TARGET FOLDER\n");
    return 2;
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(argv[2])) {
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    std::printf("%s\n", file.c_str());
    std::fflush(stdout);  // the last line names the file of a crash
    const std::string bytes = rgbd_pose::ReadTextFile(file.string());
    // A copy of exactly this size: a memory checker finds reads past its end.
    const std::vector<uint8_t> copy(bytes.begin(), bytes.end());
    rgbd_pose::Targets()[argv[1]](copy.data(), copy.size());
  }
  return files.empty() ? 1 : 0;
}
