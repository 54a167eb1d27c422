#include <gmock/gmock.h>

#include <filesystem>
#include <functional>

#include "core/util/text_file.h"
#include "frontend/sources/frame_stream.h"
#include "tests/frontend/sources/stray_scanner_fixture.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

namespace fs = std::filesystem;

TEST_F(StrayScannerTest, RefusesWhatIsDamaged) {
  const auto write = [this](const char* name, const std::string& text) {
    return [this, name, text] { folder_.Write(name, text); };
  };
  const std::string header = std::string(kStrayHeader) + "\n";
  const std::string row = StrayRowText(100.0, 0, Rigid3d()) + "\n";
  struct {
    std::function<void()> spoil;
    std::vector<std::string> said;
  } const cases[] = {
      {[this] { fs::remove(folder_ / "rgb.mp4"); }, {"rgb.mp4: missing"}},
      {write("rgb.mp4", "nothing of a video"),
       {"rgb.mp4: cannot be read as a video"}},
      {[this] { fs::resize_file(folder_ / "rgb.mp4", 2000); },
       {"rgb.mp4: cannot be read as a video"}},
      {[this] { fs::remove(folder_ / "odometry.csv"); }, {"odometry.csv"}},
      {write("odometry.csv", header + row + StrayRowText(101.0, 1, Rigid3d()) +
                                 "\n" + StrayRowText(102.0, 2, Rigid3d()) +
                                 "\n" + StrayRowText(103.0, 3, Rigid3d())),
       {"rgb.mp4: has 3 images, but odometry.csv has 4 rows"}},
      {[this] { fs::remove(folder_ / "camera_matrix.csv"); },
       {"camera_matrix.csv"}},
      {[this] { fs::remove_all(folder_ / "depth"); },
       {"depth: has no image (000000.png)", ".npy"}},
      {[this] {
         WriteImage(folder_ / "confidence/000000.png",
                    cv::Mat::zeros(10, 10, CV_8UC1));
       },
       {"confidence/000000.png: differs in size from", "depth/000000.png"}},
  };
  RecordPlain(3);
  const fs::path good = folder_ / "good";
  fs::create_directory(good);
  for (const char* name : {"rgb.mp4", "odometry.csv", "camera_matrix.csv"}) {
    fs::copy(folder_ / name, good / name);
  }
  fs::copy(folder_ / "depth", good / "depth");
  fs::copy(folder_ / "confidence", good / "confidence");
  for (const auto& c : cases) {
    c.spoil();
    ExpectInputError([this] { First(); }, c.said);
    fs::copy(
        good, folder_.path(),
        fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  }
  First();
}

TEST_F(StrayScannerTest, EndsWhereTheVideoBreaksOff) {
  RecordPlain(12);
  std::string bytes = ReadTextFile(folder_ / "rgb.mp4");
  const size_t frames = bytes.find("mdat");
  const size_t end = bytes.find("moov");
  for (size_t i = frames + (end - frames) / 2; i < end - 4; ++i) bytes[i] = 0;
  folder_.Write("rgb.mp4", bytes);
  const auto source = Open();
  FrameStream stream(source.get(), {}, 2, 0.05);
  int good = 0;
  while (stream.Next().has_value()) ++good;
  EXPECT_GT(good, 3);
  EXPECT_LT(good, 12);
  EXPECT_THAT(stream.stopped(),
              testing::HasSubstr(Format("rgb.mp4: only %d of 12 images can be "
                                        "decoded",
                                        good)));
}

}  // namespace
}  // namespace rgbd_pose
