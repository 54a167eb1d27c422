#include "frontend/frame/image_pyramid.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace rgbd_pose {
namespace {

template <typename Pixel>
ImageView<Pixel> ViewImage(const cv::Mat& image) {
  return {image.ptr<Pixel>(), image.cols, image.rows,
          static_cast<ptrdiff_t>(image.step / sizeof(Pixel))};
}

}  // namespace

ImagePyramid::ImagePyramid(const PreparedFrame& frame) : levels{frame.gray} {
  constexpr size_t kMaxLevels = 6;
  constexpr int kMinSidePx = 8;
  while (levels.size() < kMaxLevels) {
    const cv::Mat& finer = levels.back();
    const cv::Size half(finer.cols / 2, finer.rows / 2);
    if (std::min(half.width, half.height) < kMinSidePx) break;
    // The last pixel of an odd side is dropped to keep the scale at exactly 2.
    const cv::Mat even = finer(cv::Rect(0, 0, 2 * half.width, 2 * half.height));
    cv::Mat coarser;
    cv::resize(even, coarser, half, 0.0, 0.0, cv::INTER_AREA);
    levels.push_back(coarser);
  }
}

SmoothPyramid::SmoothPyramid(const PreparedFrame& frame) : levels{frame.gray} {
  constexpr double kSigmaPx = 1.0;
  const std::vector<cv::Mat>& sharp = frame.Derived<ImagePyramid>().levels;
  for (size_t level = 1; level < sharp.size(); ++level) {
    cv::GaussianBlur(sharp[level], levels.emplace_back(), {3, 3}, kSigmaPx);
  }
}

Camera CameraOfLevel(const Camera& camera, int level) {
  Camera result = camera;
  const double scale = 1.0 / (1 << level);
  result.fx *= scale;
  result.fy *= scale;
  result.cx = (camera.cx + 0.5) * scale - 0.5;
  result.cy = (camera.cy + 0.5) * scale - 0.5;
  result.width >>= level;
  result.height >>= level;
  return result;
}

FrameView ViewFrame(const Frame& frame, const std::vector<cv::Mat>& pyramid,
                    const Camera& camera, const DepthNoiseModel& depth_noise) {
  FrameView view;
  for (size_t level = 0; level < pyramid.size(); ++level) {
    view.levels.push_back({ViewImage<uint8_t>(pyramid[level]),
                           CameraOfLevel(camera, static_cast<int>(level))});
  }
  view.depth = ViewImage<uint16_t>(frame.depth);
  view.depth_scale = frame.depth_scale;
  view.depth_noise = depth_noise;
  view.timing = frame.Timing();
  return view;
}

}  // namespace rgbd_pose
