#include "frontend/sources/frame_range.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "frontend/sources/frame_source.h"
#include "tests/support/expect_input_error.h"

namespace rgbd_pose {
namespace {

// Ten frames, half a second apart, the first at 100 s. Each can be requested
// only after it has been read.
class TenFrames : public Dataset {
 public:
  int size() const override { return 10; }
  double timestamp(int index) const override { return 100.0 + 0.5 * index; }
  Frame Read(int index) const override {
    Frame frame;
    frame.index = index;
    frame.timestamp = timestamp(index);
    ++reads;
    return frame;
  }
  const RgbdCamera& camera() const override { return camera_; }
  Trajectory ground_truth() const override { return {{100.0, {}}}; }
  mutable int reads = 0;

 private:
  RgbdCamera camera_;
};

// The frame numbers, in the whole recording, of a part of it.
std::vector<int> NumbersIn(const std::string& text) {
  auto whole = std::make_unique<TenFrames>();
  const TenFrames& frames = *whole;
  const std::unique_ptr<FrameSource> part =
      PartOf(std::move(whole), ParseFrameRange(text));
  const std::vector<double> announced = part->timestamps();
  std::vector<int> numbers;
  while (const std::optional<RgbdFrame> next = part->Next()) {
    const Frame frame = next->read();
    EXPECT_EQ(frame.index, static_cast<int>(numbers.size()));
    EXPECT_EQ(frame.timestamp, next->timestamp);
    EXPECT_LT(numbers.size(), announced.size());
    EXPECT_EQ(frame.timestamp, announced.at(numbers.size()));
    numbers.push_back(static_cast<int>((frame.timestamp - 100.0) / 0.5 + 0.5));
  }
  EXPECT_EQ(numbers.size(), announced.size());
  EXPECT_EQ(frames.reads, static_cast<int>(numbers.size()));
  EXPECT_EQ(part->ground_truth().size(), 1u);
  EXPECT_FALSE(part->Next().has_value());
  return numbers;
}

TEST(FrameRangeTest, TakesPartsByNumber) {
  EXPECT_EQ(NumbersIn("").size(), 10u);
  EXPECT_EQ(NumbersIn("0-0"), (std::vector<int>{0}));
  EXPECT_EQ(NumbersIn("2-4"), (std::vector<int>{2, 3, 4}));
  EXPECT_EQ(NumbersIn("7-"), (std::vector<int>{7, 8, 9}));
  EXPECT_EQ(NumbersIn("-2"), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(NumbersIn("1-8:3"), (std::vector<int>{1, 4, 7}));
  EXPECT_EQ(NumbersIn("5-1000:2"), (std::vector<int>{5, 7, 9}));
}

TEST(FrameRangeTest, TakesPartsByTime) {
  EXPECT_EQ(NumbersIn("1s-2.5s"), (std::vector<int>{2, 3, 4, 5}));
  EXPECT_EQ(NumbersIn("3.9s-"), (std::vector<int>{8, 9}));
  EXPECT_EQ(NumbersIn("-0.7s"), (std::vector<int>{0, 1}));
  EXPECT_EQ(NumbersIn("0s-4s:4"), (std::vector<int>{0, 4, 8}));
}

// Like a bag: the times of its frames are not known before they are read.
class UnknownTimes final : public FrameSource {
 public:
  std::optional<RgbdFrame> Next() override { return frames_.Next(); }
  const RgbdCamera& camera() const override { return frames_.camera(); }

 private:
  TenFrames frames_;
};

TEST(FrameRangeTest, ARangeBeyondTheEndIsFoundOutThere) {
  const auto part =
      PartOf(std::make_unique<UnknownTimes>(), ParseFrameRange("10-20"));
  ExpectInputError([&] { part->Next(); },
                   {"the recording has only 10 frames, none of them"});
}

TEST(FrameRangeTest, RefusesWhatIsNoPart) {
  for (const char* text : {"10-20", "4.6s-9s"}) {
    ExpectInputError(
        [&] { PartOf(std::make_unique<TenFrames>(), ParseFrameRange(text)); },
        {"only 10 frames", "none of them in this range"});
  }
  for (const char* text : {"100", "-", "a-b", "4-2", "2s-1s", "1-2s", "1.5-3",
                           "1-2:0", "1-2:x", "1-2:3:4", "1-2 ", "1--2", "0--0",
                           "--0", "nan-", "0-99999999999", "1s", "-:2"}) {
    ExpectInputError([&] { ParseFrameRange(text); }, {text, "0-99", "2.5s"});
  }
}

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
