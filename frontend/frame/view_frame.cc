#include "frontend/frame/view_frame.h"

#include "frontend/frame/image_pyramid.h"

namespace rgbd_pose {
namespace {

template <typename Pixel>
ImageView<Pixel> ViewImage(const cv::Mat& image) {
  return {image.ptr<Pixel>(), image.cols, image.rows,
          static_cast<ptrdiff_t>(image.step / sizeof(Pixel))};
}

}  // namespace

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
