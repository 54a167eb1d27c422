#include "frontend/places/keyframe.h"

#include <cmath>

#include "core/util/format.h"
#include "frontend/files/image_file.h"
#include "frontend/files/png_decoder.h"

namespace rgbd_pose {
namespace {

bool StartsWith(const std::shared_ptr<const PngBytes>& png,
                const std::string& start) {
  return png != nullptr && png->bytes.compare(0, start.size(), start) == 0;
}

}  // namespace

StoredImages::StoredImages(const Frame& frame)
    : timestamp(frame.timestamp),
      depth_delay(frame.depth_delay),
      depth_scale(frame.depth_scale),
      gray(std::make_shared<const PngBytes>(EncodePng(frame.gray))),
      depth(std::make_shared<const PngBytes>(EncodePng(frame.depth))) {}

Frame StoredImages::Restore() const {
  const std::string of =
      " image of the keyframe at " + FixedNumber(timestamp, 6);
  Frame frame;
  frame.timestamp = timestamp;
  frame.depth_delay = depth_delay;
  frame.depth_scale = depth_scale;
  frame.gray = DecodeGrayImage(gray->bytes, "the grey" + of);
  frame.depth = DecodeDepthImage(depth->bytes, "the depth" + of);
  return frame;
}

std::string StoredImages::Check(int width, int height) const {
  if (!StartsWith(gray, PngStart(width, height, 8)) ||
      !StartsWith(depth, PngStart(width, height, 16))) {
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
