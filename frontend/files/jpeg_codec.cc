#include "frontend/files/jpeg_codec.h"

#include <turbojpeg.h>

#include <memory>

#include "core/util/input_error.h"
#include "frontend/files/image_file.h"

namespace rgbd_pose {
namespace {

using Handle = std::unique_ptr<void, int (*)(tjhandle)>;

// The library fills the missing rest of a file with grey and only warns, as it
// does about much that harms no image. The markers of a scan and of the end
// cannot occur inside the compressed data.
bool IsCutOff(std::string_view bytes) {
  const size_t last_scan = bytes.rfind("\xFF\xDA");
  return last_scan == std::string_view::npos ||
         bytes.find("\xFF\xD9", last_scan) == std::string_view::npos;
}

}  // namespace

bool IsJpeg(std::string_view bytes) {
  return bytes.rfind("\xFF\xD8\xFF", 0) == 0;
}

cv::Mat DecodeJpeg(const std::string& bytes, const std::string& path,
                   bool to_gray) {
  const Handle jpeg(tjInitDecompress(), tjDestroy);
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, color_space = 0;
  const bool has_header =
      tjDecompressHeader3(jpeg.get(), data, bytes.size(), &width, &height,
                          &subsampling, &color_space) == 0 &&
      width <= kMaxImageSide && height <= kMaxImageSide;
  if (!has_header || IsCutOff(bytes)) {
    throw InputError(path + ": is damaged or cut off; copy it again");
  }
  cv::Mat image(height, width, to_gray ? CV_8UC1 : CV_8UC3);
  if (tjDecompress2(jpeg.get(), data, bytes.size(), image.data, width,
                    static_cast<int>(image.step), height,
                    to_gray ? TJPF_GRAY : TJPF_BGR, 0) != 0 &&
      tjGetErrorCode(jpeg.get()) == TJERR_FATAL) {
    throw InputError(path +
                     ": cannot be decoded: " + tjGetErrorStr2(jpeg.get()));
  }
  return image;
}

std::string EncodeJpeg(const cv::Mat& image, int quality) {
  const Handle jpeg(tjInitCompress(), tjDestroy);
  const bool is_gray = image.channels() == 1;
  unsigned char* data = nullptr;
  unsigned long size = 0;  // NOLINT(google-runtime-int): the library's type
  const int failed = tjCompress2(
      jpeg.get(), image.data, image.cols, static_cast<int>(image.step),
      image.rows, is_gray ? TJPF_GRAY : TJPF_BGR, &data, &size,
      is_gray ? TJSAMP_GRAY : TJSAMP_420, quality, TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(data,
                                                                       tjFree);
  if (failed != 0) {
    throw InputError(std::string("an image cannot be encoded as JPEG: ") +
                     tjGetErrorStr2(jpeg.get()));
  }
  return {reinterpret_cast<const char*>(data), size};
}

}  // namespace rgbd_pose
