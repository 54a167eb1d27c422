#include "frontend/features/descriptor_matching.h"

#include <gtest/gtest.h>

namespace rgbd_pose {
namespace {

// Keypoints in a row, 100 px apart, with these descriptors of one byte.
DescribedKeypoints Keypoints(const std::vector<int>& descriptors) {
  DescribedKeypoints keypoints;
  for (size_t i = 0; i < descriptors.size(); ++i) {
    keypoints.keypoints.emplace_back(100.0F * static_cast<float>(i + 1), 50.0F,
                                     31.0F);
    keypoints.descriptors.push_back(
        cv::Mat(1, 1, CV_8U, cv::Scalar(descriptors[i])));
  }
  return keypoints;
}

size_t MatchesOf(const std::vector<int>& reference,
                 const std::vector<int>& current) {
  return MatchKeypoints(kOrb, Keypoints(reference), Keypoints(current), nullptr)
      .size();
}

TEST(DescriptorMatchingTest, OfTwoEqualPlacesNeitherMatches) {
  EXPECT_EQ(MatchesOf({0}, {0, 255}), 1u);
  EXPECT_EQ(MatchesOf({0}, {1, 2}), 0u);
  EXPECT_EQ(MatchesOf({0}, {0, 0}), 0u);
}

}  // namespace
}  // namespace rgbd_pose
