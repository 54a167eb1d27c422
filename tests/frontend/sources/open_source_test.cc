#include "frontend/sources/open_source.h"

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

using OpenSourceTest = TumSequenceTest;

TEST_F(OpenSourceTest, GivesTheFramesInOrderByAnyName) {
  for (const char* name : {"auto", "tum"}) {
    const std::unique_ptr<FrameSource> source = OpenSource(name, options_);
    EXPECT_EQ(source->timestamps(), (std::vector<double>{1.00, 1.04, 1.10}));
    EXPECT_EQ(source->unmatched_color(), 1);
    EXPECT_EQ(source->camera().depth_scale, kDepthScale);
    for (const double timestamp : source->timestamps()) {
      const std::optional<RgbdFrame> next = source->Next();
      ASSERT_TRUE(next.has_value());
      EXPECT_EQ(next->timestamp, timestamp);
      EXPECT_EQ(next->read().timestamp, timestamp);
    }
    EXPECT_FALSE(source->Next().has_value());
  }
}

TEST_F(OpenSourceTest, RefusesWhatItDoesNotKnow) {
  ExpectInputError([&] { OpenSource("lidar", options_); },
                   {"unknown source 'lidar'", "auto", "tum"});
  const TempFolder other;
  options_.path = other.Write("recording.zip", "");
  ExpectInputError([&] { OpenSource("auto", options_); },
                   {options_.path, "not a supported recording",
                    "if it is an archive, unpack it", "rgb.txt and depth.txt"});
  std::filesystem::create_directory(other / "images");
  other.Write("notes.txt", "");
  options_.path = other.path();
  ExpectInputError(
      [&] { OpenSource("auto", options_); },
      {options_.path,
       "contains images/, notes.txt, recording.zip; supported recordings",
       "7-Scenes"});
  options_.path = folder_ / "nowhere";
  ExpectInputError([&] { OpenSource("auto", options_); },
                   {options_.path, "no such file or folder"});
}

TEST_F(OpenSourceTest, NamesARecordingInAFolderOfTheFolder) {
  std::filesystem::create_directories(folder_ / "archive/empty");
  std::filesystem::create_directories(folder_ / "archive/dataset");
  std::filesystem::create_directory_symlink(folder_.path(),
                                            folder_ / "archive/dataset/desk");
  options_.path = folder_ / "archive";
  ExpectInputError([&] { OpenSource("auto", options_); },
                   {"contains dataset/, empty/; give " + options_.path +
                    "/dataset/desk, which is TUM RGB-D"});
}

TEST_F(OpenSourceTest, NamesTheRecordingThatAPathIsAPartOf) {
  for (const char* part : {"rgb", "rgb/", "depth.txt"}) {
    options_.path = folder_ / part;
    ExpectInputError([&] { OpenSource("auto", options_); },
                     {options_.path, "is not a supported recording",
                      "; give " + folder_.path(), ", which is TUM RGB-D"});
  }
}

TEST_F(OpenSourceTest, RefusesOptionsOfOtherKindsOfRecordings) {
  options_.topics = {"/color", "/depth"};
  ExpectInputError([&] { OpenSource("auto", options_); },
                   {options_.path, "topics are only for bags", "TUM RGB-D"});
  options_.topics.clear();
  options_.associations_file = folder_ / "list.txt";
  ExpectInputError([&] { OpenSource("7scenes", options_); },
                   {options_.path, "only for TUM folders", "7-Scenes"});
}

}  // namespace
}  // namespace rgbd_pose
