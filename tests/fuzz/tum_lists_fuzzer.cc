// rgb.txt and depth.txt, one after the other in the input.

#include "frontend/sources/tum_dataset.h"
#include "tests/fuzz/fuzz_input.h"

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace rgbd_pose;
  // Of the images named in the lists, only their existence is checked.
  static const FuzzFolder folder;
  static const std::string image = folder.Write("a", "");
  std::string_view rest = FuzzText(data, size);
  folder.Write("rgb.txt", NextFile(&rest));
  folder.Write("depth.txt", NextFile(&rest));
  MayRefuse([&] {
    const TumLists lists = ReadTumLists(folder.path(), 0.02);
    Require(!lists.pairs.empty(), "at least one frame");
    Require(lists.unmatched_color >= 0, "a number of images");
    for (size_t i = 1; i < lists.pairs.size(); ++i) {
      Require(lists.pairs[i].timestamp > lists.pairs[i - 1].timestamp,
              "frames in strict time order");
    }
  });
  return 0;
}
