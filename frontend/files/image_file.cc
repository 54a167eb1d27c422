#include "frontend/files/image_file.h"

#include <cctype>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#ifdef RGBD_POSE_HAS_LIBDEFLATE
#include "frontend/files/png_decoder.h"
#endif

namespace rgbd_pose {
namespace {

bool IsJpeg(std::string_view bytes) {
  return bytes.rfind("\xFF\xD8\xFF", 0) == 0;
}

// OpenCV fills the missing rest of a JPEG with grey and reports success. The
// markers of a scan and of the end cannot occur inside the compressed data.
bool IsCutOffJpeg(std::string_view bytes) {
  if (!IsJpeg(bytes)) return false;
  const size_t last_scan = bytes.rfind("\xFF\xDA");
  return last_scan == std::string_view::npos ||
         bytes.find("\xFF\xD9", last_scan) == std::string_view::npos;
}

// Whether recordings use the format. Decoders of OpenCV for other formats may
// abort the program: on damaged bytes the DICOM decoder fails an assertion.
bool IsOfKnownKind(std::string_view bytes) {
  using std::string_view_literals::operator""sv;
  for (const std::string_view start : {"\x89PNG\r\n\x1A\n"sv, "\xFF\xD8\xFF"sv,
                                       "BM"sv, "II*\0"sv, "MM\0*"sv}) {
    if (bytes.rfind(start, 0) == 0) return true;
  }
  const bool is_webp = bytes.substr(0, 4) == "RIFF" && bytes.size() > 8 &&
                       bytes.substr(8, 4) == "WEBP";
  const bool is_pnm = bytes.size() > 2 && bytes[0] == 'P' && bytes[1] >= '1' &&
                      bytes[1] <= '6' &&
                      std::isspace(static_cast<unsigned char>(bytes[2])) != 0;
  return is_webp || is_pnm;
}

cv::Mat DecodeByOpenCv(const std::string& bytes, const std::string& path,
                       int flags) {
  cv::Mat image;
  try {
    // OpenCV only reads the buffer.
    const cv::Mat buffer(1, static_cast<int>(bytes.size()), CV_8UC1,
                         const_cast<char*>(bytes.data()));
    image = cv::imdecode(buffer, flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& error) {
    throw InputError(path + ": cannot be decoded: " + error.err);
  }
  if (image.empty()) {
    throw InputError(path + ": is damaged, cut off or not readable by OpenCV");
  }
  return image;
}

// Decodes an image as it is, or to gray values: 8 or 16 bits, and in colour as
// well if `color` is not null.
cv::Mat Decode(const std::string& bytes, const std::string& path, bool to_gray,
               cv::Mat* color = nullptr) {
  if (bytes.empty()) throw InputError(path + ": is empty; copy it again");
  bool is_damaged = IsCutOffJpeg(bytes);
#ifdef RGBD_POSE_HAS_LIBDEFLATE
  const PngUse use = !to_gray           ? PngUse::kDepth
                     : color == nullptr ? PngUse::kGray
                                        : PngUse::kGrayAndColor;
  const DecodedPng png = DecodePng(bytes, use);
  if (!png.image.empty()) {
    if (color != nullptr) *color = png.color;
    return png.image;
  }
  is_damaged |= png.is_damaged;
#endif
  if (is_damaged) {
    throw InputError(path + ": is damaged or cut off; copy it again");
  }
  if (!IsOfKnownKind(bytes)) {
    throw InputError(path +
                     ": is damaged, cut off or not in a supported format "
                     "(PNG, JPEG, TIFF, BMP, PGM, PPM, WebP)");
  }
  if (!to_gray) return DecodeByOpenCv(bytes, path, cv::IMREAD_UNCHANGED);
  // JPEG stores grey levels by the same formula, with less loss than colours.
  const bool is_jpeg = IsJpeg(bytes);
  if (is_jpeg && color != nullptr) {
    *color = DecodeByOpenCv(bytes, path, cv::IMREAD_COLOR);
  }
  const int mode = is_jpeg ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR;
  cv::Mat image = DecodeByOpenCv(bytes, path, mode | cv::IMREAD_ANYDEPTH);
  if (is_jpeg) return image;
  // The conversion to grey differs between OpenCV's decoders.
  if (color != nullptr) *color = image.clone();
  if (image.depth() == CV_8U) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
  return image;
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
                     ": a colour image must have 8 bits per channel, this one "
                     "has more; is it the depth image?");
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

std::string EncodePng(const cv::Mat& image, const std::vector<int>& settings) {
  std::vector<uchar> bytes;
  cv::imencode(".png", image, bytes, settings);
  return {bytes.begin(), bytes.end()};
}

// OpenCV does not detect a disk that becomes full at the end of a file.
void WritePngFile(const std::string& path, const cv::Mat& image,
                  const std::vector<int>& settings) {
  WriteFileAtomically(path, EncodePng(image, settings));
}

}  // namespace rgbd_pose
