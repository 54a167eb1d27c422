#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_pose {

// The places of up to about max_count keypoints spread over a grid: from each
// cell the strongest that `accept` takes (a depth is there, say), so that
// textured places do not crowd out the rest. In the order of the cells.
std::vector<int> SelectOverGrid(
    const std::vector<cv::KeyPoint>& keypoints, const cv::Size& image,
    int max_count, const std::function<bool(const cv::Point2f&)>& accept);

// Up to about max_corners FAST corners that `accept` takes, spread over the
// image as SelectOverGrid does.
std::vector<cv::Point2f> DetectGridCorners(
    const cv::Mat& gray, int max_corners,
    const std::function<bool(const cv::Point2f&)>& accept);

}  // namespace rgbd_pose
