// ROS recordings: a byte for the kind, then the bytes of one file, or the
// length of the first part and the bytes of two parts in a folder.

#include <algorithm>

#include "frontend/bags/bag_reader.h"
#include "frontend/sources/open_source.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using namespace rgbd_pose;

void ReadAll(const std::string& path, BagKind kind) {
  MayRefuse([&] {
    const auto bag = OpenBag(path, kind);
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
  MayRefuse([&] {
    SourceOptions options;
    options.path = path;
    const auto source = OpenSource("auto", options);
    while (const auto frame = source->Next()) {
      MayRefuse([&] { frame->read(); });
    }
  });
}

}  // namespace

FUZZ_TARGET(bag_files) {
  if (size < 3) return 0;
  static const FuzzFolder folder;
  const std::string_view bytes = FuzzText(data + 3, size - 3);
  const size_t first = data[1] + 256u * data[2];
  switch (data[0] % 4) {
    case 0:
      ReadAll(folder.Write("a.bag", bytes), BagKind::kRos1);
      break;
    case 1:
      std::filesystem::create_directory(folder.path() + "/parts");
      folder.Write("parts/a_0.bag", bytes.substr(0, first));
      folder.Write("parts/a_1.bag",
                   bytes.substr(std::min(first, bytes.size())));
      ReadAll(folder.path() + "/parts", BagKind::kRos1);
      break;
    case 2:
      ReadAll(folder.Write("a.db3", bytes), BagKind::kRos2);
      break;
    default:
      ReadAll(folder.Write("a.db3.zstd", bytes), BagKind::kRos2);
  }
  return 0;
}
