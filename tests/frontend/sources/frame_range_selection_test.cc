#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "frontend/sources/frame_range.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

// The selected frames between -1 and 30.
std::vector<int> Chosen(const std::string& text) {
  const FrameSelection selection("pictures", text);
  std::vector<int> chosen;
  for (int i = -1; i <= 30; ++i) {
    if (selection.Contains(i)) chosen.push_back(i);
  }
  return chosen;
}

TEST(FrameSelectionTest, ChoosesWhatTheTextSays) {
  struct {
    std::string text;
    std::vector<int> chosen;
  } const cases[] = {
      {"", {}},
      {"0", {0}},
      {"10,3", {3, 10}},
      {"5-8", {5, 6, 7, 8}},
      {"7-7", {7}},
      {"007", {7}},
      {"10-20:5", {10, 15, 20}},
      {"10-19:5", {10, 15}},
      {"10-12:999999999", {10}},
      {"2,4-6,5,20-30:4", {2, 4, 5, 6, 20, 24, 28}},
      {"29-999999999", {29, 30}},
  };
  for (const auto& c : cases) EXPECT_EQ(Chosen(c.text), c.chosen) << c.text;
}

TEST(FrameSelectionTest, AllHasEveryFrame) {
  const FrameSelection all("pictures", "all");
  for (const int index : {0, 1, 1000, 2147483647}) {
    EXPECT_TRUE(all.Contains(index)) << index;
  }
  EXPECT_FALSE(all.Contains(-1));
}

TEST(FrameSelectionTest, KnowsHowManyFramesItNeeds) {
  EXPECT_EQ(FrameSelection("pictures", "").LastBegin(), -1);
  EXPECT_EQ(FrameSelection("pictures", "all").LastBegin(), 0);
  EXPECT_EQ(FrameSelection("pictures", "3,10-20,7").LastBegin(), 10);
}

TEST(FrameSelectionTest, RejectsOtherText) {
  struct {
    std::string text;
    std::string named;  // the wrong part that the message must contain
  } const cases[] = {
      {"x", "'x'"},           {" ", "' '"},
      {"-1", "'-1'"},         {"+1", "'+1'"},
      {"1.5", "'1.5'"},       {"10, 20", "' 20'"},
      {"10,", "''"},          {",10", "''"},
      {"10,,20", "''"},       {"1,ALL", "'ALL'"},
      {"1,all", "'all'"},     {"5-", "'5-'"},
      {"5-3", "'5-3'"},       {"1-2-3", "'1-2-3'"},
      {"1-9:", "'1-9:'"},     {"1-9:0", "'1-9:0'"},
      {"1-9:-2", "'1-9:-2'"}, {"5:2", "'5:2'"},
      {"1-9:2x", "'1-9:2x'"}, {"9999999999", "'9999999999'"},
      {"1;2", "'1;2'"},       {"1\n2", "'1 2'"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.text);
    ExpectInputError([&c] { FrameSelection("pictures", c.text); },
                     {"--pictures=", c.named, "10,20-40,100-200:10, or all"});
  }
}

}  // namespace
}  // namespace rgbd_pose
