// rgb.txt and depth.txt, one after the other in the input.

#include "frontend/sources/open_source.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(tum_lists) {
  using namespace rgbd_pose;
  // Of the images named in the lists, only their existence is checked.
  static const FuzzFolder folder;
  static const std::string image = folder.Write("a", "");
  std::string_view rest = FuzzText(data, size);
  folder.Write("rgb.txt", NextFile(&rest));
  folder.Write("depth.txt", NextFile(&rest));
  MayRefuse([&] {
    SourceOptions options;
    options.path = folder.path();
    options.camera = RgbdCamera();
    const auto dataset = OpenTum(options);
    Require(dataset->unmatched_color() >= 0, "a number of images");
    Require(dataset->size() > 0, "at least one frame");
    for (int i = 1; i < dataset->size(); ++i) {
      Require(dataset->timestamp(i) > dataset->timestamp(i - 1),
              "frames in strict time order");
    }
  });
  return 0;
}
