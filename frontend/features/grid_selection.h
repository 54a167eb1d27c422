#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_pose {

// Returns the indices of up to about max_count keypoints spread over a grid:
// from each cell the strongest that `accept` takes (for example with depth),
// because textured places would crowd out the rest. In the order of the cells.
std::vector<int> SelectOverGrid(
    const std::vector<cv::KeyPoint>& keypoints, const cv::Size& image,
    int max_count, const std::function<bool(const cv::Point2f&)>& accept);

// Returns up to about max_corners FAST corners that `accept` takes, spread over
// the image by SelectOverGrid.
std::vector<cv::Point2f> DetectGridCorners(
    const cv::Mat& gray, int max_corners,
    const std::function<bool(const cv::Point2f&)>& accept);

}  // namespace rgbd_pose
