#include "frontend/files/image_file.h"

#include <opencv2/imgproc.hpp>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "frontend/files/jpeg_codec.h"
#include "frontend/files/png_codec.h"
#include "frontend/files/pnm_decoder.h"
#ifdef RGBD_POSE_HAS_LIBDEFLATE
#include "frontend/files/png_decoder.h"
#endif

namespace rgbd_pose {
namespace {

// Decodes an image as it is, or to gray values: 8 or 16 bits, and in colour as
// well if `color` is not null.
cv::Mat Decode(const std::string& bytes, const std::string& path, bool to_gray,
               cv::Mat* color = nullptr) {
  if (bytes.empty()) throw InputError(path + ": is empty; copy it again");
  if (IsJpeg(bytes)) {
    if (!to_gray) return DecodeJpeg(bytes, path, /*to_gray=*/false);
    // It stores grey levels by the same formula, with less loss than colours.
    if (color != nullptr) *color = DecodeJpeg(bytes, path, /*to_gray=*/false);
    return DecodeJpeg(bytes, path, /*to_gray=*/true);
  }
#ifdef RGBD_POSE_HAS_LIBDEFLATE
  const PngUse use = !to_gray           ? PngUse::kDepth
                     : color == nullptr ? PngUse::kGray
                                        : PngUse::kGrayAndColor;
  const DecodedPng png = DecodePng(bytes, use);
  if (!png.image.empty()) {
    if (color != nullptr) *color = png.color;
    return png.image;
  }
  if (png.is_damaged) {
    throw InputError(path + ": is damaged or cut off; copy it again");
  }
#endif
  cv::Mat image;
  if (IsPng(bytes)) {
    image = DecodeAnyPng(bytes, path, /*to_color=*/to_gray);
  } else if (IsPnm(bytes)) {
    image = DecodePnm(bytes, path);
  } else {
    throw InputError(path +
                     ": is damaged, cut off or not in a supported format "
                     "(PNG, JPEG, PGM, PPM)");
  }
  if (!to_gray) return image;
  cv::Mat gray = image;
  if (image.type() == CV_8UC3) {
    cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  } else if (image.type() == CV_8UC1) {
    image = cv::Mat();
    cv::cvtColor(gray, image, cv::COLOR_GRAY2BGR);
  }
  if (color != nullptr) *color = image;
  return gray;
}

}  // namespace

cv::Mat ReadImageFile(const std::string& path) {
  return Decode(ReadTextFile(path), path, /*to_gray=*/false);
}

cv::Mat ReadGrayImageFile(const std::string& path, cv::Mat* color) {
  return DecodeGrayImage(ReadTextFile(path), path, color);
}

cv::Mat DecodeGrayImage(const std::string& bytes, const std::string& path,
                        cv::Mat* color) {
  cv::Mat gray = Decode(bytes, path, /*to_gray=*/true, color);
  if (gray.type() != CV_8UC1) {
    throw InputError(path +
                     ": a colour image or a mask must have 8 bits per channel, "
                     "this one has more; is it a depth image?");
  }
  return gray;
}

cv::Mat ReadDepthImageFile(const std::string& path) {
  return DecodeDepthImage(ReadTextFile(path), path);
}

cv::Mat DecodeDepthImage(const std::string& bytes, const std::string& path) {
  cv::Mat depth = Decode(bytes, path, /*to_gray=*/false);
  if (depth.type() != CV_16UC1) {
    throw InputError(path +
                     ": a depth image must have 16 bits and 1 channel, "
                     "this one is " +
                     cv::typeToString(depth.type()) +
                     "; is it the colour image, or a depth image for display?");
  }
  return depth;
}

void WritePngFile(const std::string& path, const cv::Mat& image) {
  WriteFileAtomically(path, EncodePng(image));
}

}  // namespace rgbd_pose
