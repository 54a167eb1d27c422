#include "frontend/frame/image_pyramid.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "frontend/frame/view_frame.h"

namespace rgbd_pose {
namespace {

constexpr int kMinSidePx = 8;
constexpr int kLevelsOfFrame = 6;

void Smooth(const std::vector<cv::Mat>& sharp, std::vector<cv::Mat>* pyramid) {
  constexpr double kSigmaPx = 1.0;
  pyramid->resize(sharp.size());
  (*pyramid)[0] = sharp[0];
  for (size_t level = 1; level < sharp.size(); ++level) {
    cv::GaussianBlur(sharp[level], (*pyramid)[level], {3, 3}, kSigmaPx);
  }
}

template <typename Pixel>
ImageView<Pixel> ViewImage(const cv::Mat& image) {
  return {image.ptr<Pixel>(), image.cols, image.rows,
          static_cast<ptrdiff_t>(image.step / sizeof(Pixel))};
}

}  // namespace

void BuildImagePyramid(const cv::Mat& gray, int levels,
                       std::vector<cv::Mat>* pyramid) {
  pyramid->resize(levels);
  (*pyramid)[0] = gray;
  for (int level = 1; level < levels; ++level) {
    const cv::Mat& finer = (*pyramid)[level - 1];
    const cv::Size half(finer.cols / 2, finer.rows / 2);
    if (std::min(half.width, half.height) < kMinSidePx) {
      pyramid->resize(level);
      return;
    }
    // The last pixel of an odd side is dropped to keep the scale at exactly 2.
    const cv::Mat even = finer(cv::Rect(0, 0, 2 * half.width, 2 * half.height));
    cv::resize(even, (*pyramid)[level], half, 0.0, 0.0, cv::INTER_AREA);
  }
}

void BuildSmoothPyramid(const cv::Mat& gray, int levels,
                        std::vector<cv::Mat>* pyramid) {
  std::vector<cv::Mat> sharp;
  BuildImagePyramid(gray, levels, &sharp);
  Smooth(sharp, pyramid);
}

ImagePyramid::ImagePyramid(const PreparedFrame& frame) {
  BuildImagePyramid(frame.gray, kLevelsOfFrame, &levels);
}

SmoothPyramid::SmoothPyramid(const PreparedFrame& frame) {
  Smooth(frame.Derived<ImagePyramid>().levels, &levels);
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
