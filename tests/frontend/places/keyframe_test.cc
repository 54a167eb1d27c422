#include "frontend/places/keyframe.h"

#include <gtest/gtest.h>

#include "tests/support/expect_input_error.h"
#include "tests/support/map_parts.h"

namespace rgbd_pose {
namespace {

TEST(StoredImagesTest, RestoresTheFrame) {
  Frame frame = NoiseFrame(1);
  frame.timestamp = 12.3;
  frame.depth_delay = -0.01;
  frame.depth_scale = 1000.0;
  const Frame restored = StoredImages(frame).Restore();
  EXPECT_EQ(restored.timestamp, 12.3);
  EXPECT_EQ(restored.depth_delay, -0.01);
  EXPECT_EQ(restored.depth_scale, 1000.0);
  EXPECT_EQ(cv::norm(restored.gray, frame.gray, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(restored.depth, frame.depth, cv::NORM_INF), 0);
  EXPECT_EQ(restored.gray.type(), CV_8UC1);
  EXPECT_EQ(restored.depth.type(), CV_16UC1);
}

// A map has hundreds of these, which must not waste memory.
TEST(StoredImagesTest, HaveNoRoomToSpare) {
  const StoredImages images(NoiseFrame(1));
  EXPECT_EQ(images.gray->bytes.capacity(), images.gray->bytes.size());
  EXPECT_EQ(images.depth->bytes.capacity(), images.depth->bytes.size());
}

TEST(StoredImagesTest, CopiesShareTheImages) {
  const StoredImages images(NoiseFrame(1));
  const StoredImages copy = images;
  EXPECT_EQ(copy.gray, images.gray);
  EXPECT_EQ(copy.depth, images.depth);
}

TEST(StoredImagesTest, SaysWhatIsWrong) {
  const StoredImages good(NoiseFrame(1));
  const auto check = [](const StoredImages& images) {
    return images.Check(kMapWidth, kMapHeight);
  };
  EXPECT_EQ(check(good), "");
  const std::string kKind =
      "the images must be PNG files of 32 x 24 pixels, 8-bit grey and "
      "16-bit depth";
  EXPECT_EQ(check(StoredImages()), kKind);
  EXPECT_NE(good.Check(kMapWidth, kMapHeight + 1), "");
  StoredImages swapped = good;
  swapped.gray.swap(swapped.depth);
  EXPECT_EQ(check(swapped), kKind);
  StoredImages cut = good;
  cut.depth = std::make_shared<PngBytes>(good.depth->bytes.substr(0, 20));
  EXPECT_EQ(check(cut), kKind);
  for (double StoredImages::*value :
       {&StoredImages::timestamp, &StoredImages::depth_delay,
        &StoredImages::depth_scale}) {
    StoredImages bad = good;
    bad.*value = NAN;
    EXPECT_NE(check(bad), "");
  }
}

TEST(StoredImagesTest, RefusesDamagedImages) {
  StoredImages images(NoiseFrame(1));
  images.timestamp = 12.3;
  std::string bytes = images.depth->bytes;
  bytes[bytes.size() / 2] ^= 1;
  images.depth = std::make_shared<PngBytes>(bytes);
  ExpectInputError([&] { images.Restore(); },
                   {"the depth image of the keyframe at 12.300000", "damaged"});
  images.depth = nullptr;
  ExpectInputError([&] { images.Restore(); },
                   {"there is no image of the keyframe at 12.300000"});
}

}  // namespace
}  // namespace rgbd_pose
