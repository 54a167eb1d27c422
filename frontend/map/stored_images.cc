#include "frontend/map/stored_images.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "core/util/format.h"
#include "frontend/sources/image_file.h"

namespace rgbd_pose {
namespace {

// OpenCV's fastest level, which predicts a pixel by its left neighbour. For
// grey it looks for runs only, by default; of depth, which has few values,
// repetitions are worth a search. Higher levels take over twice as long for a
// tenth less.
const std::vector<int> kGraySettings = {};
const std::vector<int> kDepthSettings = {cv::IMWRITE_PNG_STRATEGY,
                                         cv::IMWRITE_PNG_STRATEGY_DEFAULT};

std::shared_ptr<const PngBytes> Compress(const cv::Mat& image,
                                         const std::vector<int>& settings) {
  return std::make_shared<const PngBytes>(EncodePng(image, settings));
}

std::string BigEndian(uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<char>(value >> shift & 0xff));
  }
  return bytes;
}

// How a PNG file with one channel of so many bits begins (PNG Specification,
// sections 5.2 and 11.2.2).
std::string PngStart(int width, int height, int bits) {
  constexpr char kGray = 0;
  return "\x89PNG\r\n\x1A\n" + BigEndian(13) + "IHDR" + BigEndian(width) +
         BigEndian(height) + static_cast<char>(bits) + kGray;
}

bool StartsWith(const std::shared_ptr<const PngBytes>& png,
                const std::string& start) {
  return png != nullptr && png->bytes.compare(0, start.size(), start) == 0;
}

}  // namespace

PngBytes::PngBytes(std::string file)
    : bytes(std::move(file)), checksum([this] {
        TextHash hash;
        hash.Add(bytes);
        return hash.Hex();
      }()) {}

StoredImages::StoredImages(const Frame& frame)
    : timestamp(frame.timestamp),
      depth_delay(frame.depth_delay),
      depth_scale(frame.depth_scale),
      gray(Compress(frame.gray, kGraySettings)),
      depth(Compress(frame.depth, kDepthSettings)) {}

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
        "the images must be PNG files of %d x %d pixels with 8 bits "
        "of grey and 16 of depth",
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
