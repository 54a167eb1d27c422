// Files that associate colour and depth images.

#include "frontend/files/png_codec.h"
#include "frontend/sources/open_source.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

// Writes the images that the input may name: `a` is colour and `b` depth.
void WriteImages(const rgbd_pose::FuzzFolder& folder) {
  for (const int type : {CV_8UC1, CV_16UC1}) {
    folder.Write(type == CV_8UC1 ? "a" : "b",
                 rgbd_pose::EncodePng(cv::Mat(2, 2, type, cv::Scalar(7))));
  }
}

}  // namespace

FUZZ_TARGET(associations) {
  using namespace rgbd_pose;
  static const FuzzFolder folder;
  static const bool once = (WriteImages(folder), true);
  (void)once;
  const std::string file =
      folder.Write("associations.txt", FuzzText(data, size));
  MayRefuse([&] {
    SourceOptions options;
    options.path = folder.path();
    options.associations_file = file;
    options.camera = RgbdCamera();
    const auto dataset = OpenTum(options);
    Require(dataset->size() > 0, "at least one frame");
    for (int i = 1; i < dataset->size(); ++i) {
      Require(dataset->timestamp(i) > dataset->timestamp(i - 1),
              "frames in strict time order");
    }
  });
  return 0;
}
