#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <vector>

namespace rgbd_pose {

// Up to about max_corners FAST corners that `accept` takes, spread over the
// image as SelectOverGrid does.
std::vector<cv::Point2f> DetectGridCorners(
    const cv::Mat& gray, int max_corners,
    const std::function<bool(const cv::Point2f&)>& accept);

}  // namespace rgbd_pose
