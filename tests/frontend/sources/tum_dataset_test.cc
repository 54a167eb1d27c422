#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <thread>

#include "frontend/sources/image_pairing.h"
#include "frontend/sources/open_source.h"
#include "tests/support/tum_sequence.h"

namespace rgbd_pose {
namespace {

using TumDatasetTest = TumSequenceTest;

// Expects all three frames of the fixture.
void ExpectFrames(const Dataset& dataset) {
  ASSERT_EQ(dataset.size(), 3);
  const int images[] = {0, 1, 3};
  const double timestamps[] = {1.00, 1.04, 1.10};
  for (int i = 0; i < 3; ++i) {
    const Frame frame = dataset.Read(i);
    EXPECT_EQ(frame.index, i);
    EXPECT_EQ(frame.timestamp, timestamps[i]);
    EXPECT_EQ(dataset.timestamp(i), timestamps[i]);
    EXPECT_EQ(frame.depth_scale, kDepthScale);
    ASSERT_EQ(frame.gray.type(), CV_8UC1);
    ASSERT_EQ(frame.gray.size(), cv::Size(kWidth, kHeight));
    EXPECT_EQ(cv::norm(frame.depth, DepthImage(images[i]), cv::NORM_INF), 0);
  }
}

TEST_F(TumDatasetTest, AssociatesTheListsItself) {
  const auto dataset = OpenTum(options_);
  ExpectFrames(*dataset);
  EXPECT_EQ(dataset->unmatched_color(), 1);
  EXPECT_EQ(dataset->camera().camera.width, kWidth);
}

TEST_F(TumDatasetTest, AssociationsAloneAreEnough) {
  std::filesystem::remove(folder_ / "rgb.txt");
  std::filesystem::remove(folder_ / "depth.txt");
  UseAssociations(
      "1.00 rgb/0.png 1.005 depth/0.png\n"
      "1.04 rgb/1.jpg 1.039 depth/1.png\n"
      "1.10 rgb/3.png 1.11 depth/3.png\n");
  ExpectFrames(*OpenTum(options_));
  options_.associations_file.clear();  // they are found in the folder
  ExpectFrames(*OpenTum(options_));
}

TEST_F(TumDatasetTest, TakesTheTimeDifferenceFromItsOptions) {
  options_.max_time_difference = 0.002;
  const auto dataset = OpenTum(options_);
  EXPECT_EQ(dataset->size(), 1);
  EXPECT_EQ(dataset->timestamp(0), 1.04);
  EXPECT_EQ(dataset->unmatched_color(), 3);
}

TEST_F(TumDatasetTest, ReadsGrayAndColor) {
  options_.keep_color = true;
  const auto dataset = OpenTum(options_);
  // 0.299 red + 0.587 green + 0.114 blue, rounded; JPEG may be off by 2 levels.
  EXPECT_NEAR(dataset->Read(0).gray.at<uint8_t>(5, 5), 69, 1);
  EXPECT_NEAR(dataset->Read(1).gray.at<uint8_t>(5, 5), 70, 2);
  const cv::Mat color = dataset->Read(2).color;
  ASSERT_EQ(color.type(), CV_8UC3);
  EXPECT_EQ(color.at<cv::Vec3b>(5, 5), cv::Vec3b(13, 63, 113));
}

// Keeping colours, e.g. for a cloud, must not change the trajectory.
TEST_F(TumDatasetTest, KeepsColourWithTheSameGray) {
  const auto gray_alone = OpenTum(options_);
  options_.keep_color = true;
  const auto dataset = OpenTum(options_);
  for (int i = 0; i < dataset->size(); ++i) {
    EXPECT_TRUE(gray_alone->Read(i).color.empty());
    const Frame frame = dataset->Read(i);
    EXPECT_EQ(cv::norm(frame.gray, gray_alone->Read(i).gray, cv::NORM_INF), 0);
    EXPECT_NEAR(frame.color.at<cv::Vec3b>(5, 5)[2], 110 + i, 3);
  }
}

TEST_F(TumDatasetTest, DepthIsMetresAndZeroWhereThereIsNone) {
  const Frame frame = OpenTum(options_)->Read(0);
  EXPECT_EQ(frame.DepthAt(0, 0), 0.0);
  EXPECT_EQ(frame.DepthAt(1, 0), 0.0);
  EXPECT_EQ(frame.DepthAt(2, 0), 1.0);
}

TEST_F(TumDatasetTest, TakesCarriageReturnsAndAByteOrderMark) {
  folder_.Write("rgb.txt",
                "\xEF\xBB\xBF"
                "1.00 rgb/0.png\r\n1.04 rgb/1.jpg\r\n\r\n1.10 rgb/3.png");
  const auto dataset = OpenTum(options_);
  ExpectFrames(*dataset);
  EXPECT_EQ(dataset->unmatched_color(), 0);
}

TEST_F(TumDatasetTest, TakesAssociationsInEitherOrder) {
  UseAssociations(
      "1.00 rgb/0.png 1.005 depth/0.png\n"
      "1.04 rgb/1.jpg 1.039 depth/1.png\n"
      "1.10 rgb/3.png 1.11 depth/3.png\n");
  ExpectFrames(*OpenTum(options_));
  UseAssociations(
      "1.005 depth/0.png 1.00 rgb/0.png\n"
      "1.039 depth/1.png 1.04 rgb/1.jpg\n"
      "1.11 depth/3.png 1.10 rgb/3.png\n");
  ExpectFrames(*OpenTum(options_));
}

TEST_F(TumDatasetTest, SaysHowMuchLaterDepthIs) {
  UseAssociations(
      "1.005 depth/0.png 1.00 rgb/0.png\n"
      "1.039 depth/1.png 1.04 rgb/1.jpg\n");
  const auto dataset = OpenTum(options_);
  constexpr double kRounding = 1e-9;  // s
  EXPECT_NEAR(dataset->Read(0).depth_delay, 0.005, kRounding);
  EXPECT_NEAR(dataset->Read(1).depth_delay, -0.001, kRounding);
}

TEST_F(TumDatasetTest, TellsAssociatedImagesApartByLookingAtThem) {
  std::filesystem::rename(folder_ / "depth", folder_ / "d");
  UseAssociations("1.00 rgb/0.png 1.005 d/0.png\n");
  EXPECT_EQ(OpenTum(options_)->timestamp(0), 1.00);
  UseAssociations("1.005 d/0.png 1.00 rgb/0.png\n");
  const auto dataset = OpenTum(options_);
  EXPECT_EQ(dataset->timestamp(0), 1.00);
  EXPECT_EQ(dataset->Read(0).depth.at<uint16_t>(3, 3), 1000);
}

TEST_F(TumDatasetTest, MentionsMasksThatFitNoImage) {
  folder_.Write("mask/0.jpg", "");
  const std::vector<std::string> remarks = OpenTum(options_)->remarks();
  ASSERT_EQ(remarks.size(), 1u);
  EXPECT_NE(remarks[0].find("has no mask of a colour image, such as 0.png"),
            std::string::npos);
}

TEST_F(TumDatasetTest, ReadsFromSeveralThreads) {
  const auto dataset = OpenTum(options_);
  std::vector<std::thread> threads(4);
  for (std::thread& thread : threads) {
    thread = std::thread([&dataset] {
      for (int repeat = 0; repeat < 20; ++repeat) ExpectFrames(*dataset);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST_F(TumDatasetTest, RefusesBadOptions) {
  options_.max_time_difference = -0.1;
  ExpectRefused({"time difference"});
  options_.max_time_difference = 0.02;
  options_.camera->depth_scale = 0.0;
  ExpectRefused({"depth scale"});
  options_.camera = SmallCamera();
  options_.camera->camera.fx = 0.0;
  ExpectRefused({"camera: ", "fx"});
  options_.camera = SmallCamera();
  options_.path = folder_ / "nowhere";
  ExpectRefused({"nowhere", "folder"});
}

TEST_F(TumDatasetTest, RefusesImagesOfAnotherSizeOrKind) {
  WriteImage(folder_ / "depth/0.png", ColorImage(0));
  ExpectReadRefused({"depth/0.png", "16 bits", "CV_8UC3"});
  WriteImage(folder_ / "depth/0.png", cv::Mat(24, 31, CV_16UC1, cv::Scalar(7)));
  ExpectReadRefused({"depth/0.png", "31 x 24", "32 x 24"});
  WriteImage(folder_ / "rgb/0.png", cv::Mat(48, 64, CV_8UC3, cv::Scalar(7)));
  ExpectReadRefused({"rgb/0.png", "64 x 48", "32 x 24"});
}

using TumListsTest = TumSequenceTest;

TEST_F(TumListsTest, ABadOneIsRefusedNamingFileAndLine) {
  const std::string kRgb = "rgb.txt", kDepth = "depth.txt";
  const std::string kPairs = "associations.txt";
  const struct {
    std::string file;  // the list to replace
    std::string text;
    std::vector<std::string> message_parts;
  } kCases[] = {
      {kRgb, "", {"rgb.txt: "}},
      {kDepth, "# a\n\n", {"depth.txt: "}},
      {kRgb, "# x\n1.04 rgb/1.jpg\n1.00 rgb/0.png\n", {":3:", "earlier"}},
      {kRgb, "1.0 a.png\nnan b.jpg\n", {"rgb.txt:2:", "'nan'", "time stamp"}},
      {kRgb, "rgb/0.png 1.0\n", {"rgb.txt:1:", "'rgb/0.png'"}},
      {kRgb, "1.0 a.png\n\n1.04\n", {"rgb.txt:3:", "2 columns", "'1.04'"}},
      {kDepth, "7.5 depth/0.png\n", {"rgb.txt", "depth.txt", "1.0", "7.5"}},
      {kPairs, "#\n", {"associations.txt: "}},
      {kPairs,
       "1.00 rgb/0.png 1.005 depth/0.png\n1.04 rgb/1.jpg 1.039\n",
       {"associations.txt:2:", "4 columns", "has 3", "'1.04 rgb/1.jpg 1.039'"}},
      {kPairs, "rgb/0.png 1.00 depth/0.png 1.005\n", {":1:", "'rgb/0.png'"}},
      {kPairs, "1.00 rgb/0.png nan depth/0.png\n", {":1:", "'nan'"}},
      {kPairs,
       "1.039 depth/1.png 1.04 rgb/1.jpg\n"
       "1.005 depth/0.png 1.00 rgb/0.png\n",
       {":2:", "earlier"}},
      {kPairs,
       "1.00 rgb/0.png 1.005 rgb/3.png\n",
       {"associations.txt:1:", "colour", "depth", "rgb/3.png"}}};
  for (const auto& bad : kCases) {
    SCOPED_TRACE(bad.text);
    SetUp();
    options_.associations_file.clear();
    const std::string path = folder_.Write(bad.file, bad.text);
    if (bad.file == kPairs) options_.associations_file = path;
    std::vector<std::string> message_parts = bad.message_parts;
    message_parts.push_back(bad.file);
    ExpectRefused(message_parts);
  }
}

// Unreadable images are detected later, when they are read.
TEST_F(TumListsTest, TakesOneImageOfATimeStamp) {
  folder_.Write("depth.txt",
                "1.005 depth/0.png\n1.005 depth/9.png\n1.04 depth/1.png\n");
  const std::string remark = SameStampRemark(folder_.path(), 1);
  auto dataset = OpenTum(options_);
  ASSERT_EQ(dataset->size(), 2);
  EXPECT_EQ(dataset->remarks(), std::vector<std::string>{remark});
  EXPECT_EQ(dataset->Read(0).depth.at<uint16_t>(3, 3), 1000);
  UseAssociations("1 rgb/0.png 1 depth/0.png\n1 rgb/1.jpg 1 depth/9.png\n");
  dataset = OpenTum(options_);
  EXPECT_EQ(dataset->size(), 1);
  EXPECT_EQ(dataset->remarks(), std::vector<std::string>{remark});
}

TEST_F(TumListsTest, SaysThatTimesAreProbablyNotInSeconds) {
  UseAssociations(
      "33 rgb/0.png 33 depth/0.png\n67 rgb/1.jpg 67 depth/1.png\n"
      "100 rgb/3.png 100 depth/3.png\n");
  EXPECT_EQ(OpenTum(options_)->remarks(),
            std::vector<std::string>{
                folder_.path() +
                ": frames are 33.5 s apart; are their time stamps milli- or "
                "microseconds? They must be in seconds"});
}

TEST_F(TumListsTest, RefusesAMissingList) {
  std::filesystem::remove(folder_ / "rgb.txt");
  ExpectRefused({"rgb.txt: missing"});
  options_.associations_file = folder_ / "pairs.txt";
  ExpectRefused({"pairs.txt"});
}

}  // namespace
}  // namespace rgbd_pose
