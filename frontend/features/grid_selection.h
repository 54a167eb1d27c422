#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// Returns the indices of about max_count keypoints of a frame spread over a
// grid, at most about twice as many: from each cell the strongest with depth,
// because textured places would crowd out the rest. In the order of the cells.
std::vector<int> SelectOverGrid(const std::vector<cv::KeyPoint>& keypoints,
                                const Frame& frame, int max_count,
                                const DepthLookupOptions& depth_options);

// Returns about max_corners FAST corners by SelectOverGrid.
std::vector<cv::Point2f> DetectGridCorners(
    const Frame& frame, int max_corners,
    const DepthLookupOptions& depth_options);

}  // namespace rgbd_pose
