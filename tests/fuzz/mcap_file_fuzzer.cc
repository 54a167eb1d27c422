// mcap recordings: their topics, the first messages, all messages.

#include "frontend/bags/bag_reader.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(mcap_file) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("a.mcap", FuzzText(data, size));
  MayRefuse([&] {
    const auto bag = OpenMcapFile(file);
    std::vector<std::string> all;
    for (const BagTopic& topic : bag->topics()) {
      MayRefuse([&] { bag->First(topic.name, 2); });
      all.push_back(topic.name);
    }
    const auto next = bag->MessagesOf(all);
    while (const auto message = next()) {
      Require(bag->FindTopic(message->topic) != nullptr, "a topic");
    }
  });
  return 0;
}
