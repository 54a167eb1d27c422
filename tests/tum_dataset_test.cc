#include "frontend/tum_dataset.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "core/input_error.h"
#include "core/text_file.h"
#include "frontend/camera_file.h"
#include "tests/temp_folder.h"

namespace rgbd_pose {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int kWidth = 32;
constexpr int kHeight = 24;
constexpr double kDepthScale = 1000.0;

RgbdCamera SmallCamera() {
  return {{kWidth, kHeight, 30, 30, 15.5, 11.5}, kDepthScale};
}

// Image k differs from the others in each pixel.
cv::Mat ColorImage(int k) {
  return cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(10 + k, 60 + k, 110 + k));
}

cv::Mat DepthImage(int k) {
  cv::Mat image(kHeight, kWidth, CV_16UC1, cv::Scalar(1000 + k));
  image.at<uint16_t>(0, 0) = 0;
  image.at<uint16_t>(0, 1) = Frame::kNoDepth;
  return image;
}

void WriteImage(const std::string& path, const cv::Mat& image) {
  ASSERT_TRUE(cv::imwrite(path, image)) << path;
}

// A folder with three frames; colour image 2 (1.07 s) has no depth image.
class TumDatasetTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_.Write("rgb.txt",
                  "# time image\n"
                  "1.00 rgb/0.png\n"
                  "1.04 rgb/1.jpg\n"
                  "1.07 rgb/2.png\n"
                  "1.10 rgb/3.png\n");
    folder_.Write("depth.txt",
                  "1.005 depth/0.png\n"
                  "1.039 depth/1.png\n"
                  "1.11 depth/3.png\n");
    std::filesystem::create_directory(folder_ / "rgb");
    std::filesystem::create_directory(folder_ / "depth");
    for (const int k : {0, 1, 3}) {
      const std::string type = k == 1 ? ".jpg" : ".png";
      WriteImage(folder_ / ("rgb/" + std::to_string(k) + type), ColorImage(k));
      WriteImage(folder_ / ("depth/" + std::to_string(k) + ".png"),
                 DepthImage(k));
    }
    options_.folder = folder_.path();
    options_.camera = SmallCamera();
  }

  void UseAssociations(const std::string& text) {
    options_.associations_file = folder_.Write("associations.txt", text);
  }

  // Leaves the first `bytes` bytes of a file, or all but -bytes if negative.
  void Cut(const std::string& name, int bytes) {
    std::string content = ReadTextFile(folder_ / name);
    content.resize(bytes >= 0 ? bytes : content.size() + bytes);
    folder_.Write(name, content);
  }

  void ExpectFrames(const TumDataset& dataset) {
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

  TempFolder folder_;
  TumDatasetOptions options_;
};

TEST_F(TumDatasetTest, AssociatesTheListsItself) {
  const TumDataset dataset(options_);
  ExpectFrames(dataset);
  EXPECT_EQ(dataset.unmatched_color(), 1);
  EXPECT_EQ(dataset.camera().camera.width, kWidth);
}

TEST_F(TumDatasetTest, TakesTheTimeDifferenceFromItsOptions) {
  options_.max_time_difference = 0.002;
  const TumDataset dataset(options_);
  EXPECT_EQ(dataset.size(), 1);
  EXPECT_EQ(dataset.timestamp(0), 1.04);
  EXPECT_EQ(dataset.unmatched_color(), 3);
}

TEST_F(TumDatasetTest, ReadsGrayAndColor) {
  const TumDataset dataset(options_);
  // 0.299 red + 0.587 green + 0.114 blue, rounded; JPEG may be 2 levels off.
  EXPECT_NEAR(dataset.Read(0).gray.at<uint8_t>(5, 5), 69, 1);
  EXPECT_NEAR(dataset.Read(1).gray.at<uint8_t>(5, 5), 70, 2);
  const cv::Mat color = dataset.ReadColor(2);
  ASSERT_EQ(color.type(), CV_8UC3);
  EXPECT_EQ(color.at<cv::Vec3b>(5, 5), cv::Vec3b(13, 63, 113));
}

TEST_F(TumDatasetTest, DepthIsMetresAndZeroWhereThereIsNone) {
  const Frame frame = TumDataset(options_).Read(0);
  EXPECT_EQ(frame.DepthAt(0, 0), 0.0);
  EXPECT_EQ(frame.DepthAt(1, 0), 0.0);
  EXPECT_EQ(frame.DepthAt(2, 0), 1.0);
}

TEST_F(TumDatasetTest, TakesCarriageReturnsAndAByteOrderMark) {
  folder_.Write("rgb.txt",
                "\xEF\xBB\xBF"
                "1.00 rgb/0.png\r\n1.04 rgb/1.jpg\r\n\r\n1.10 rgb/3.png");
  const TumDataset dataset(options_);
  ExpectFrames(dataset);
  EXPECT_EQ(dataset.unmatched_color(), 0);
}

TEST_F(TumDatasetTest, TakesAssociationsInEitherOrder) {
  UseAssociations(
      "1.00 rgb/0.png 1.005 depth/0.png\n"
      "1.04 rgb/1.jpg 1.039 depth/1.png\n"
      "1.10 rgb/3.png 1.11 depth/3.png\n");
  ExpectFrames(TumDataset(options_));
  UseAssociations(
      "1.005 depth/0.png 1.00 rgb/0.png\n"
      "1.039 depth/1.png 1.04 rgb/1.jpg\n"
      "1.11 depth/3.png 1.10 rgb/3.png\n");
  ExpectFrames(TumDataset(options_));
}

TEST_F(TumDatasetTest, TellsAssociatedImagesApartByLookingAtThem) {
  std::filesystem::rename(folder_ / "depth", folder_ / "d");
  UseAssociations("1.00 rgb/0.png 1.005 d/0.png\n");
  EXPECT_EQ(TumDataset(options_).timestamp(0), 1.00);
  UseAssociations("1.005 d/0.png 1.00 rgb/0.png\n");
  const TumDataset dataset(options_);
  EXPECT_EQ(dataset.timestamp(0), 1.00);
  EXPECT_EQ(dataset.Read(0).depth.at<uint16_t>(3, 3), 1000);
}

TEST_F(TumDatasetTest, NeedsNoListsBesideAssociations) {
  std::filesystem::remove(folder_ / "rgb.txt");
  std::filesystem::remove(folder_ / "depth.txt");
  UseAssociations("1.00 rgb/0.png 1.005 depth/0.png\n");
  EXPECT_EQ(TumDataset(options_).size(), 1);
}

TEST_F(TumDatasetTest, MissesNoImageThatNoFrameNeeds) {
  EXPECT_FALSE(std::filesystem::exists(folder_ / "rgb/2.png"));
  EXPECT_NO_THROW(TumDataset{options_});
}

TEST_F(TumDatasetTest, ReadsFromSeveralThreads) {
  const TumDataset dataset(options_);
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([this, &dataset] {
      for (int repeat = 0; repeat < 20; ++repeat) ExpectFrames(dataset);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

// Bad input: the fixture's sequence with one thing spoilt.
class BadTumDatasetTest : public TumDatasetTest {
 protected:
  // Expects an InputError of one line that names all of `parts`, from the
  // constructor or, for a bad image, from Read(0).
  void ExpectRefused(const std::vector<std::string>& parts) {
    Expect([this] { TumDataset{options_}; }, parts);
  }
  void ExpectReadRefused(const std::vector<std::string>& parts) {
    const TumDataset dataset(options_);
    Expect([&dataset] { dataset.Read(0); }, parts);
  }

 private:
  void Expect(const std::function<void()>& call,
              const std::vector<std::string>& parts) {
    try {
      call();
      ADD_FAILURE() << "took bad input";
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), Not(HasSubstr("\n")));
      for (const std::string& part : parts) {
        EXPECT_THAT(error.what(), HasSubstr(part));
      }
    }
  }
};

struct BadText {
  const char* name;
  const char* file;  // the list that is replaced
  const char* text;
  std::vector<std::string> message_parts;
};

class BadTumListTest : public BadTumDatasetTest,
                       public testing::WithParamInterface<BadText> {};

TEST_P(BadTumListTest, IsRefusedNamingFileAndLine) {
  const std::string path = folder_.Write(GetParam().file, GetParam().text);
  if (GetParam().file == std::string("associations.txt")) {
    options_.associations_file = path;
  }
  ExpectRefused(GetParam().message_parts);
}

INSTANTIATE_TEST_SUITE_P(
    Tum, BadTumListTest,
    testing::Values(
        BadText{"Empty", "rgb.txt", "", {"rgb.txt: "}},
        BadText{"OnlyComments", "depth.txt", "# a\n\n", {"depth.txt: "}},
        BadText{"OutOfOrder",
                "rgb.txt",
                "# x\n1.04 rgb/1.jpg\n1.00 rgb/0.png\n",
                {"rgb.txt:3:", "earlier"}},
        BadText{"Doubled",
                "depth.txt",
                "1.005 depth/0.png\n1.005 depth/1.png\n",
                {"depth.txt:2:", "same time stamp"}},
        BadText{"NaN",
                "rgb.txt",
                "1.0 rgb/0.png\nnan rgb/1.jpg\n",
                {"rgb.txt:2:", "'nan'", "time stamp"}},
        BadText{"NoNumber",
                "rgb.txt",
                "rgb/0.png 1.0\n",
                {"rgb.txt:1:", "'rgb/0.png'"}},
        BadText{"OneColumn",
                "rgb.txt",
                "1.0 rgb/0.png\n\n1.04\n",
                {"rgb.txt:3:", "2 columns", "'1.04'"}},
        BadText{"MissingColorImage",
                "rgb.txt",
                "1.0 rgb/9.png\n",
                {"rgb.txt:1:", "rgb/9.png"}},
        BadText{"MissingDepthImage",
                "depth.txt",
                "1.0 depth/9.png\n",
                {"depth.txt:1:", "depth/9.png"}},
        BadText{"FolderForImage", "rgb.txt", "1.0 rgb\n", {"rgb.txt:1:"}},
        BadText{"NothingAssociates",
                "depth.txt",
                "7.5 depth/0.png\n",
                {"rgb.txt", "depth.txt", "1.0", "7.5"}},
        BadText{"AssociationsEmpty",
                "associations.txt",
                "#\n",
                {"associations.txt: "}},
        BadText{"AssociationsThreeColumns",
                "associations.txt",
                "1.00 rgb/0.png 1.005 depth/0.png\n1.04 rgb/1.jpg 1.039\n",
                {"associations.txt:2:", "4 columns", "has 3",
                 "'1.04 rgb/1.jpg 1.039'"}},
        BadText{"AssociationsPathForTime",
                "associations.txt",
                "rgb/0.png 1.00 depth/0.png 1.005\n",
                {"associations.txt:1:", "'rgb/0.png'"}},
        BadText{"AssociationsNaN",
                "associations.txt",
                "1.00 rgb/0.png nan depth/0.png\n",
                {"associations.txt:1:", "'nan'"}},
        BadText{"AssociationsOutOfOrder",
                "associations.txt",
                "1.039 depth/1.png 1.04 rgb/1.jpg\n"
                "1.005 depth/0.png 1.00 rgb/0.png\n",
                {"associations.txt:2:", "earlier"}},
        BadText{"AssociationsMissingImage",
                "associations.txt",
                "1.00 rgb/0.png 1.005 depth/9.png\n",
                {"associations.txt:1:", "depth/9.png"}},
        BadText{"AssociationsOnlyColor",
                "associations.txt",
                "1.00 rgb/0.png 1.005 rgb/3.png\n",
                {"associations.txt:1:", "colour", "depth", "rgb/3.png"}}),
    [](const auto& info) { return info.param.name; });

TEST_F(BadTumDatasetTest, MissingFolder) {
  options_.folder = folder_ / "nowhere";
  ExpectRefused({"nowhere", "folder"});
}

TEST_F(BadTumDatasetTest, MissingList) {
  std::filesystem::remove(folder_ / "rgb.txt");
  ExpectRefused({"rgb.txt: missing"});
}

TEST_F(BadTumDatasetTest, MissingAssociations) {
  options_.associations_file = folder_ / "pairs.txt";
  ExpectRefused({"pairs.txt"});
}

TEST_F(BadTumDatasetTest, BadOptions) {
  options_.max_time_difference = -0.1;
  ExpectRefused({"time difference"});
  options_.max_time_difference = 0.02;
  options_.camera.depth_scale = 0.0;
  ExpectRefused({"depth scale"});
  options_.camera = SmallCamera();
  options_.camera.camera.fx = 0.0;
  ExpectRefused({"camera: ", "fx"});
}

TEST_F(BadTumDatasetTest, DepthWithEightBits) {
  WriteImage(folder_ / "depth/0.png",
             cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(7)));
  ExpectReadRefused({"depth/0.png", "16 bits", "CV_8UC1"});
}

TEST_F(BadTumDatasetTest, DepthWithThreeChannels) {
  WriteImage(folder_ / "depth/0.png", ColorImage(0));
  ExpectReadRefused({"depth/0.png", "16 bits", "CV_8UC3"});
}

TEST_F(BadTumDatasetTest, ColorOfAnotherSize) {
  WriteImage(folder_ / "rgb/0.png", cv::Mat(48, 64, CV_8UC3, cv::Scalar(7)));
  ExpectReadRefused({"rgb/0.png", "64 x 48", "32 x 24"});
  EXPECT_THROW(TumDataset(options_).ReadColor(0), InputError);
}

TEST_F(BadTumDatasetTest, DepthOfAnotherSize) {
  WriteImage(folder_ / "depth/0.png", cv::Mat(24, 31, CV_16UC1, cv::Scalar(7)));
  ExpectReadRefused({"depth/0.png", "31 x 24", "32 x 24"});
}

TEST_F(BadTumDatasetTest, CutOffImages) {
  for (const int bytes : {0, 5, 60, -1}) {
    WriteImage(folder_ / "depth/0.png", DepthImage(0));
    Cut("depth/0.png", bytes);
    ExpectReadRefused({"depth/0.png"});
  }
  WriteImage(folder_ / "depth/0.png", DepthImage(0));
  for (const int bytes : {0, 5, 60, -1}) {
    WriteImage(folder_ / "rgb/0.png", ColorImage(0));
    Cut("rgb/0.png", bytes);
    ExpectReadRefused({"rgb/0.png"});
  }
}

// OpenCV itself takes these, with grey for what is missing.
TEST_F(BadTumDatasetTest, CutOffJpeg) {
  cv::Mat texture(kHeight, kWidth, CV_8UC3);
  cv::RNG(1).fill(texture, cv::RNG::UNIFORM, 0, 255);
  folder_.Write("rgb.txt", "1.00 rgb/0.jpg\n");
  for (const int bytes : {0, 2, 100, 700, -300, -2, -1}) {
    WriteImage(folder_ / "rgb/0.jpg", texture);
    Cut("rgb/0.jpg", bytes);
    ExpectReadRefused({"rgb/0.jpg"});
  }
}

TEST_F(BadTumDatasetTest, TextForAnImage) {
  folder_.Write("rgb/0.png", "no image");
  ExpectReadRefused({"rgb/0.png", "no image"});
}

// Real sequences, which are not part of the project: RGBD_POSE_TEST_DATA names
// the folder that holds them.
class RealTumDatasetTest : public testing::TestWithParam<const char*> {};

TEST_P(RealTumDatasetTest, IsReadInFull) {
  const char* data = std::getenv("RGBD_POSE_TEST_DATA");
  if (data == nullptr) {
    GTEST_SKIP() << "needs " << GetParam() << " in RGBD_POSE_TEST_DATA";
  }
  TumDatasetOptions options;
  options.folder = std::string(data) + "/" + GetParam();
  options.camera = ReadCameraFile(options.folder + "/camera.yaml");
  const TumDataset dataset(options);
  ASSERT_GT(dataset.size(), 0);
  for (const int i : {0, dataset.size() - 1}) {
    const Frame frame = dataset.Read(i);
    EXPECT_EQ(frame.gray.size(), frame.depth.size());
    EXPECT_GT(cv::countNonZero(frame.depth), 0);
  }
  // The association file that came with the sequence, if any, says the same.
  options.associations_file = options.folder + "/associations.txt";
  if (!std::filesystem::exists(options.associations_file)) return;
  const TumDataset associated(options);
  ASSERT_EQ(associated.size(), dataset.size());
  for (int i = 0; i < dataset.size(); ++i) {
    EXPECT_EQ(associated.timestamp(i), dataset.timestamp(i));
  }
}

INSTANTIATE_TEST_SUITE_P(Tum, RealTumDatasetTest,
                         testing::Values("redkitchen400", "tum_fr1_360_5",
                                         "tum_fr1_xyz_3", "tum_fr2_hall50"),
                         [](const auto& info) { return info.param; });

}  // namespace
}  // namespace rgbd_pose
