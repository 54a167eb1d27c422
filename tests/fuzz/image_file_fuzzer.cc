// Images of any kind, with the decoder that accepts them.

#include "frontend/files/image_file.h"
#include "tests/fuzz/fuzz_input.h"

FUZZ_TARGET(image_file) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  const std::string file = folder.Write("image", FuzzText(data, size));
  MayRefuse([&] {
    Require(ReadGrayImageFile(file).type() == CV_8UC1, "gray values");
  });
  MayRefuse([&] { Require(!ReadImageFile(file).empty(), "an image"); });
  MayRefuse([&] {
    Require(ReadDepthImageFile(file).type() == CV_16UC1, "raw depths");
  });
  return 0;
}
