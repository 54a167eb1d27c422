// mcap recordings: their topics, the first messages, all messages.

#include "frontend/bags/bag_reader.h"
#include "tests/fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("a.mcap", FuzzText(data, size));
  MayRefuse([&] {
    const auto bag = OpenMcapFile(file);
    std::vector<int> all;
    for (int i = 0; i < static_cast<int>(bag->topics().size()); ++i) {
      MayRefuse([&] { bag->First(i, 2); });
      all.push_back(i);
    }
    bag->Select(all);
    while (const auto message = bag->Next()) {
      Require(message->topic < static_cast<int>(all.size()), "a topic");
    }
  });
  return 0;
}
