#include "frontend/bags/ros_image.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>

#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "frontend/files/image_file.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {
namespace {

struct Encoding {
  const char* name;
  RosImageUse use;
  int type;     // of OpenCV
  int to_gray;  // code for cv::cvtColor; -1: no conversion
  int to_color;
};

constexpr Encoding kEncodings[] = {
    {"rgb8", RosImageUse::kColor, CV_8UC3, cv::COLOR_RGB2GRAY,
     cv::COLOR_RGB2BGR},
    {"bgr8", RosImageUse::kColor, CV_8UC3, cv::COLOR_BGR2GRAY, -1},
    {"rgba8", RosImageUse::kColor, CV_8UC4, cv::COLOR_RGBA2GRAY,
     cv::COLOR_RGBA2BGR},
    {"bgra8", RosImageUse::kColor, CV_8UC4, cv::COLOR_BGRA2GRAY,
     cv::COLOR_BGRA2BGR},
    {"8UC3", RosImageUse::kColor, CV_8UC3, cv::COLOR_BGR2GRAY, -1},
    {"yuv422", RosImageUse::kRawColor, CV_8UC2, cv::COLOR_YUV2GRAY_UYVY,
     cv::COLOR_YUV2BGR_UYVY},
    {"uyvy", RosImageUse::kRawColor, CV_8UC2, cv::COLOR_YUV2GRAY_UYVY,
     cv::COLOR_YUV2BGR_UYVY},
    {"yuv422_yuy2", RosImageUse::kRawColor, CV_8UC2, cv::COLOR_YUV2GRAY_YUY2,
     cv::COLOR_YUV2BGR_YUY2},
    {"yuyv", RosImageUse::kRawColor, CV_8UC2, cv::COLOR_YUV2GRAY_YUY2,
     cv::COLOR_YUV2BGR_YUY2},
    // OpenCV names a pattern by the second and third pixel of the second row.
    {"bayer_rggb8", RosImageUse::kRawColor, CV_8UC1, cv::COLOR_BayerBG2GRAY,
     cv::COLOR_BayerBG2BGR},
    {"bayer_bggr8", RosImageUse::kRawColor, CV_8UC1, cv::COLOR_BayerRG2GRAY,
     cv::COLOR_BayerRG2BGR},
    {"bayer_gbrg8", RosImageUse::kRawColor, CV_8UC1, cv::COLOR_BayerGR2GRAY,
     cv::COLOR_BayerGR2BGR},
    {"bayer_grbg8", RosImageUse::kRawColor, CV_8UC1, cv::COLOR_BayerGB2GRAY,
     cv::COLOR_BayerGB2BGR},
    {"mono8", RosImageUse::kGray, CV_8UC1, -1, cv::COLOR_GRAY2BGR},
    {"8UC1", RosImageUse::kGray, CV_8UC1, -1, cv::COLOR_GRAY2BGR},
    {"16UC1", RosImageUse::kDepth, CV_16UC1, -1, -1},
    {"mono16", RosImageUse::kGrayOrDepth, CV_16UC1, -1, -1},
    {"32FC1", RosImageUse::kMetricDepth, CV_32FC1, -1, -1},
};

// An example of compressed depth is "16UC1; compressedDepth png". Other images
// have formats such as "jpeg" or "rgb8; jpeg compressed bgr8".
bool IsCompressedDepth(std::string_view format) {
  return format.find("compressedDepth") != std::string_view::npos;
}

InputError Unreadable(const std::string& name, std::string_view encoding,
                      const char* what) {
  return InputError(name + ": encoding '" + std::string(encoding) +
                    "' is not supported for " + what +
                    " images; known encodings: " + Join(NamesOf(kEncodings)) +
                    ", compressed jpeg and png");
}

// The pixels without conversion. Rows of bytes share the memory of the message;
// wider numbers are copied, as they may not be aligned in the message.
cv::Mat PixelRows(const RosImage& image, const Encoding& encoding,
                  const std::string& name) {
  const size_t row_bytes = size_t{image.width} * CV_ELEM_SIZE(encoding.type);
  if (image.step < row_bytes ||
      image.data.size() < size_t{image.step} * image.height) {
    throw InputError(name + ": holds " + std::to_string(image.data.size()) +
                     " bytes, too few for " + std::to_string(image.width) +
                     " x " + std::to_string(image.height) + " pixels of " +
                     encoding.name);
  }
  constexpr uint32_t kMaxSize = 1 << 16;
  if (image.width > kMaxSize || image.height > kMaxSize) {
    throw InputError(name + ": is too large to be an image");
  }
  if (image.height == 0) throw InputError(name + ": is empty");
  if (encoding.type == CV_8UC2 && image.width % 2 != 0) {
    throw InputError(name + Format(": is %u pixels wide, but %s has pairs of "
                                   "pixels",
                                   image.width, encoding.name));
  }
  const auto width = static_cast<int>(image.width);
  const auto height = static_cast<int>(image.height);
  if (CV_ELEM_SIZE1(encoding.type) == 1) {  // callers only read the pixels
    return cv::Mat(height, width, encoding.type,
                   const_cast<char*>(image.data.data()), image.step);
  }
  cv::Mat rows(height, width, encoding.type);
  for (int y = 0; y < height; ++y) {
    std::memcpy(rows.ptr(y), image.data.data() + size_t{image.step} * y,
                row_bytes);
  }
  if (image.is_bigendian) {
    const size_t size = CV_ELEM_SIZE1(encoding.type);
    for (uint8_t* at = rows.data; at < rows.dataend; at += size) {
      std::reverse(at, at + size);
    }
  }
  return rows;
}

// A copy of pixels, converted by a code for cv::cvtColor unless it is -1.
cv::Mat Converted(const cv::Mat& rows, int code) {
  if (code < 0) return rows.clone();
  cv::Mat converted;
  cv::cvtColor(rows, converted, code);
  return converted;
}

// The image file in a compressed message. Only JPEG and PNG, which ROS uses,
// are accepted; untrusted bytes of other formats are passed to no parser.
std::string FileIn(std::string_view bytes, const std::string& name) {
  if (bytes.rfind("\xFF\xD8\xFF", 0) != 0 && bytes.rfind("\x89PNG", 0) != 0) {
    throw InputError(name + ": is neither a JPEG nor a PNG file");
  }
  return std::string(bytes);
}

uint16_t RawDepth(double metres, double depth_scale) {
  const double raw = std::round(metres * depth_scale);
  return raw > 0.0 && raw < Frame::kNoDepth ? static_cast<uint16_t>(raw) : 0;
}

// Floating-point depth is in metres (REP 118). Some drivers write millimetres,
// which would all be too far.
void CheckIsInMetres(const cv::Mat& depth, const std::string& name) {
  constexpr float kTooFar = 100.0F;  // for any camera, m
  int measured = 0, too_far = 0;
  for (const float metres : cv::Mat_<float>(depth)) {
    if (!(metres > 0.0F) || std::isinf(metres)) continue;
    ++measured;
    too_far += metres > kTooFar ? 1 : 0;
  }
  if (2 * too_far <= measured) return;
  throw InputError(name + Format(": more than half of the depths are beyond %g "
                                 "m; floating-point depth must be in metres "
                                 "(REP 118): if these are millimetres, write "
                                 "them as 16UC1",
                                 kTooFar));
}

// A PNG file after 12 bytes: 4 unused bytes and two floats, A and B. Depth in
// metres is stored as A / depth + B.
cv::Mat DecodeCompressedDepth(const RosImage& image, const std::string& name,
                              double depth_scale) {
  constexpr size_t kHeader = 12;
  if (image.encoding.find("rvl") != std::string_view::npos) {
    throw Unreadable(name, image.encoding, "depth");
  }
  if (image.data.size() < kHeader) {
    throw InputError(name + ": the compressed depth image has no header");
  }
  float quantisation[2];
  std::memcpy(quantisation, image.data.data() + 4, sizeof(quantisation));
  cv::Mat depth =
      DecodeDepthImage(FileIn(image.data.substr(kHeader), name), name);
  if (image.encoding.substr(0, 5) != "32FC1") return depth;
  for (uint16_t& raw : cv::Mat_<uint16_t>(depth)) {
    if (raw == 0) continue;
    raw = RawDepth(quantisation[0] / (raw - quantisation[1]), depth_scale);
  }
  return depth;
}

}  // namespace

RosImageUse UseOfEncoding(std::string_view encoding) {
  if (IsCompressedDepth(encoding)) {
    return encoding.substr(0, 5) == "32FC1" ? RosImageUse::kMetricDepth
                                            : RosImageUse::kDepth;
  }
  const Encoding* row =
      FindNamed(kEncodings, encoding.substr(0, encoding.find(';')));
  if (row != nullptr) return row->use;
  const bool is_file = encoding.find("jpeg") != encoding.npos ||
                       encoding.find("jpg") != encoding.npos ||
                       encoding.find("png") != encoding.npos;
  return is_file ? RosImageUse::kColor : RosImageUse::kOther;
}

cv::Mat DecodeRosGray(const RosImage& image, const std::string& name,
                      cv::Mat* color) {
  if (image.width == 0) {  // compressed
    if (IsCompressedDepth(image.encoding)) {
      throw Unreadable(name, image.encoding, "colour");
    }
    return DecodeGrayImage(FileIn(image.data, name), name, color);
  }
  const Encoding* encoding = FindNamed(kEncodings, image.encoding);
  if (encoding == nullptr || CV_MAT_DEPTH(encoding->type) != CV_8U) {
    throw Unreadable(name, image.encoding, "colour");
  }
  const cv::Mat rows = PixelRows(image, *encoding, name);
  if (color != nullptr) *color = Converted(rows, encoding->to_color);
  return Converted(rows, encoding->to_gray);
}

cv::Mat DecodeRosDepth(const RosImage& image, const std::string& name,
                       double depth_scale) {
  if (image.width == 0) {  // compressed
    return IsCompressedDepth(image.encoding)
               ? DecodeCompressedDepth(image, name, depth_scale)
               : DecodeDepthImage(FileIn(image.data, name), name);
  }
  const Encoding* encoding = FindNamed(kEncodings, image.encoding);
  if (encoding == nullptr || CV_MAT_DEPTH(encoding->type) == CV_8U) {
    throw Unreadable(name, image.encoding, "depth");
  }
  cv::Mat rows = PixelRows(image, *encoding, name);
  if (encoding->type == CV_16UC1) return rows;
  CheckIsInMetres(rows, name);
  cv::Mat depth(rows.size(), CV_16UC1);
  std::transform(rows.begin<float>(), rows.end<float>(),
                 depth.begin<uint16_t>(),
                 [=](float metres) { return RawDepth(metres, depth_scale); });
  return depth;
}

}  // namespace rgbd_pose
