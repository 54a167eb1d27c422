// Lists of sequences.

#include <filesystem>
#include <set>

#include "apps/batch/batch_plan.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(batch_list) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  std::filesystem::create_directories(folder.path() + "/a");
  std::filesystem::create_directories(folder.path() + "/b");
  const std::string_view text = FuzzText(data, size);
  // Patterns must not search the whole machine.
  if (text.find('/') != std::string_view::npos) return 0;
  folder.Write("a/camera.yaml", "");
  const std::string file = folder.Write("list.txt", text);
  MayRefuse([&] {
    std::set<std::string> names;
    for (const BatchSequence& sequence : ReadSequenceList(file)) {
      Require(names.insert(sequence.name).second, "names that differ");
      Require(std::filesystem::is_directory(sequence.folder), "a folder");
    }
    Require(!names.empty(), "at least one sequence");
  });
  return 0;
}
