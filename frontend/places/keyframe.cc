#include "frontend/places/keyframe.h"

#include <cmath>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "frontend/files/image_file.h"
#include "frontend/files/png_codec.h"
#include "frontend/files/png_decoder.h"

namespace rgbd_pose {

StoredImages::StoredImages(const Frame& frame)
    : timestamp(frame.timestamp),
      depth_delay(frame.depth_delay),
      depth_scale(frame.depth_scale),
      gray(std::make_shared<const PngBytes>(EncodePng(frame.gray))),
      depth(std::make_shared<const PngBytes>(EncodePng(frame.depth))) {}

Frame StoredImages::Restore() const {
  const std::string of =
      " image of the keyframe at " + Format("%.6f", timestamp);
  if (gray == nullptr || depth == nullptr) {
    throw InputError("there is no" + of);
  }
  Frame frame = {0, timestamp, depth_delay};
  frame.depth_scale = depth_scale;
  frame.gray = DecodeGrayImage(gray->bytes, "the grey" + of);
  frame.depth = DecodeDepthImage(depth->bytes, "the depth" + of);
  return frame;
}

std::string StoredImages::Check(int width, int height) const {
  const auto is_png = [=](const std::shared_ptr<const PngBytes>& png,
                          int bits) {
    return png != nullptr &&
           png->bytes.rfind(PngStart(width, height, bits), 0) == 0;
  };
  if (!is_png(gray, 8) || !is_png(depth, 16)) {
    return Format(
        "the images must be PNG files of %d x %d pixels, 8-bit grey and "
        "16-bit depth",
        width, height);
  }
  if (!std::isfinite(timestamp) || !std::isfinite(depth_delay)) {
    return "times must be finite numbers";
  }
  if (!(depth_scale > 0.0 && std::isfinite(depth_scale))) {
    return "the depth scale must be a positive number";
  }
  return "";
}

}  // namespace rgbd_pose
