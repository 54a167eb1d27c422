#pragma once

#include <opencv2/core.hpp>

namespace rgbd_pose {

// A depth image (CV_16UC1, 0: none) at another resolution: `place` has for each
// pixel of the new one where in `depth` its centre is, px. Between four depths
// of one surface, else the nearest one of them, so that edges stay where they
// were measured. Beyond the border there is none.
cv::Mat ResampleDepth(const cv::Mat& depth, const cv::Size& size,
                      const cv::Matx23d& place);

}  // namespace rgbd_pose
