#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "apps/batch/batch_plan.h"
#include "tests/support/expect_input_error.h"
#include "tests/support/temp_folder.h"

namespace rgbd_pose {
namespace {

class BatchListTest : public testing::Test {
 protected:
  BatchListTest() {
    for (const std::string name : {"b", "a", "c"}) {
      folder_.Write("data/" + name + "/camera.yaml", "");
    }
    folder_.Write("data/file", "");
    folder_.Write("other/a/rgb.txt", "");
    folder_.Write("mine.yaml", "");
  }

  std::vector<BatchSequence> Read(const std::string& text) const {
    return ReadSequenceList(folder_.Write("lists/list.txt", text));
  }

  void ExpectRefused(const std::string& text,
                     const std::vector<std::string>& parts) const {
    SCOPED_TRACE(text);
    ExpectInputError([&] { Read(text); }, parts);
  }

  const TempFolder folder_;
};

TEST_F(BatchListTest, PathsCountFromTheList) {
  const auto sequences = Read(
      "# folder camera\n\n"
      "../data/b  # with its own camera\n"
      "../data/a/ tum_fr1\n" +
      (folder_ / "data/c") + " ../mine.yaml\n");
  ASSERT_EQ(sequences.size(), 3u);
  EXPECT_EQ(sequences[0].name, "b");
  EXPECT_EQ(sequences[0].folder, folder_ / "data/b");
  EXPECT_EQ(sequences[0].camera, folder_ / "data/b/camera.yaml");
  EXPECT_EQ(sequences[1].name, "a");
  EXPECT_EQ(sequences[1].folder, folder_ / "data/a");
  EXPECT_EQ(sequences[1].camera, "tum_fr1");
  EXPECT_EQ(sequences[2].folder, folder_ / "data/c");
  EXPECT_EQ(sequences[2].camera, folder_ / "mine.yaml");
}

TEST_F(BatchListTest, OnlyWordsOfTheListArePatterns) {
  folder_.Write("b[1]*/data/x/camera.yaml", "");
  const auto sequences =
      ReadSequenceList(folder_.Write("b[1]*/list.txt", "data/?\n"));
  ASSERT_EQ(sequences.size(), 1u);
  EXPECT_EQ(sequences[0].folder, folder_ / "b[1]*/data/x");
}

TEST_F(BatchListTest, KnowsBagsAndFoldersWithACalibration) {
  folder_.Write("data/x.mcap.zstd", "");
  folder_.Write("data/old/rgb.txt", "");
  folder_.Write("data/old/calibration.txt", "");
  const auto sequences = Read("../data/x.mcap.zstd\n../data/old\n");
  ASSERT_EQ(sequences.size(), 2u);
  EXPECT_EQ(sequences[1].camera, "");
}

TEST_F(BatchListTest, APatternStandsForAllFoldersInOrder) {
  const auto sequences = Read("../data/* ros_default\n");
  ASSERT_EQ(sequences.size(), 3u);
  EXPECT_EQ(sequences[0].name, "a");
  EXPECT_EQ(sequences[1].name, "b");
  EXPECT_EQ(sequences[2].name, "c");
  EXPECT_EQ(sequences[2].camera, "ros_default");
}

TEST_F(BatchListTest, ALinkGivesAnotherName) {
  std::filesystem::create_directory_symlink(folder_ / "other/a",
                                            folder_ / "other/a2");
  const auto sequences = Read("../data/a\n../other/a2 tum_fr1\n");
  ASSERT_EQ(sequences.size(), 2u);
  EXPECT_EQ(sequences[1].name, "a2");
}

TEST_F(BatchListTest, PathsWithSpacesAreInQuotationMarks) {
  folder_.Write("my data/a #1/camera.yaml", "");
  folder_.Write("my camera.yaml", "");
  const auto sequences = Read(
      "\"../my data/a*\" # \"a comment\"\n"
      "../data/b, \"../my camera.yaml\"\r\n");
  ASSERT_EQ(sequences.size(), 2u);
  EXPECT_EQ(sequences[0].folder, folder_ / "my data/a #1");
  EXPECT_EQ(sequences[1].camera, folder_ / "my camera.yaml");
  ExpectRefused("../data/a\n../my data/a b\n",
                {"list.txt:2", "has 3; put a path with spaces in quotation"});
  ExpectRefused("\"../my data/a b\n",
                {"list.txt:1: a quotation mark is not closed"});
}

TEST_F(BatchListTest, BadLinesAreNamed) {
  ExpectRefused("# nothing\n", {"list.txt", "lists no sequences"});
  ExpectRefused("../data/a\n../data/d\n",
                {"list.txt:2: no such folder: ../data/d"});
  ExpectRefused("../data/file\n", {"list.txt:1: no such folder: ../data/file"});
  ExpectRefused("../data/x*\n", {"list.txt:1: no such folder: ../data/x*"});
  ExpectRefused(
      "../data/a tum_fr1 5\n",
      {"list.txt:1: needs one or two columns (folder camera), has 3"});
  ExpectRefused("../data/a kinnect\n", {"list.txt:1", "kinnect", "tum_fr1"});
  ExpectRefused("../other/a\n", {"list.txt:1", "other/a/camera.yaml"});
  ExpectRefused("../data/a\n\n../other/a tum_fr1\n",
                {"list.txt:3: sequence name 'a' is already used in line 1"});
  ExpectRefused("../data/*\n../data/a\n", {"list.txt:2", "'a'", "line 1"});
  folder_.Write("data/.hidden/rgb.txt", "");
  ExpectRefused("../data/.hidden tum_fr1\n",
                {"list.txt:1: '.hidden' is not a valid name"});
  ExpectInputError([this] { ReadSequenceList(folder_ / "none"); },
                   {folder_ / "none: cannot be opened"});
}

}  // namespace
}  // namespace rgbd_pose
