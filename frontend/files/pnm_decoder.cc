// The formats are described at https://netpbm.sourceforge.net/doc/ppm.html.

#include "frontend/files/pnm_decoder.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "core/util/input_error.h"
#include "frontend/files/image_file.h"

namespace rgbd_pose {
namespace {

constexpr int kMaxValue = 65535;

bool IsSpace(char c) {
  return std::isspace(static_cast<unsigned char>(c)) != 0;
}
bool IsDigit(char c) { return c >= '0' && c <= '9'; }

// Removes a number, and what is before it, from the header. Returns -1 if there
// is none or it is too large.
int NextNumber(std::string_view* bytes) {
  const auto skip = [bytes](auto is_wanted) {
    while (!bytes->empty() && is_wanted(bytes->front()))
      bytes->remove_prefix(1);
  };
  skip(IsSpace);
  while (!bytes->empty() && bytes->front() == '#') {
    skip([](char c) { return c != '\n'; });
    skip(IsSpace);
  }
  int number = bytes->empty() || !IsDigit(bytes->front()) ? -1 : 0;
  skip([&number](char c) {
    if (!IsDigit(c) || number > kMaxValue) return false;
    number = 10 * number + (c - '0');
    return true;
  });
  return number > kMaxValue ? -1 : number;
}

}  // namespace

bool IsPnm(std::string_view bytes) {
  return bytes.size() > 2 && bytes[0] == 'P' &&
         (bytes[1] == '5' || bytes[1] == '6') && IsSpace(bytes[2]);
}

cv::Mat DecodePnm(const std::string& bytes, const std::string& path) {
  const int channels = bytes[1] == '6' ? 3 : 1;
  std::string_view rest = std::string_view(bytes).substr(2);
  const int width = NextNumber(&rest), height = NextNumber(&rest),
            largest = NextNumber(&rest);
  const size_t value_size = largest > 255 ? 2 : 1;
  const bool is_valid = width > 0 && width <= kMaxImageSide && height > 0 &&
                        height <= kMaxImageSide && largest > 0 &&
                        !rest.empty() && IsSpace(rest.front());
  // One space is before the pixels.
  if (!is_valid || rest.size() - 1 < value_size * channels * width * height) {
    throw InputError(path + ": is damaged or cut off; copy it again");
  }
  rest.remove_prefix(1);
  cv::Mat image(height, width, CV_8UC(channels));
  if (value_size == 2) {
    image.create(height, width, CV_16UC(channels));
    const auto* const data = reinterpret_cast<const uint8_t*>(rest.data());
    auto* const values = image.ptr<uint16_t>();
    for (size_t i = 0; i < image.total() * channels; ++i) {
      values[i] = static_cast<uint16_t>(data[2 * i] << 8 | data[2 * i + 1]);
    }
  } else {
    std::copy_n(rest.data(), image.total() * channels,
                reinterpret_cast<char*>(image.data));
  }
  if (channels == 3) cv::cvtColor(image, image, cv::COLOR_RGB2BGR);
  return image;
}

}  // namespace rgbd_pose
