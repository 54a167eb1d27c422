#pragma once

#include <opencv2/core.hpp>

namespace rgbd_pose {

// Resamples a depth image (CV_16UC1, 0: no depth). `place` maps the centre of a
// pixel of the result to its position in `depth`, px. Interpolates between four
// depths of one surface; otherwise takes the nearest one, so edges are not
// smeared. There is no depth beyond the border.
cv::Mat ResampleDepth(const cv::Mat& depth, const cv::Size& size,
                      const cv::Matx23d& place);

}  // namespace rgbd_pose
