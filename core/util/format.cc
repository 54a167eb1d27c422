#include "core/util/format.h"

#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>

namespace rgbd_pose {

std::string Format(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  const int length = std::vsnprintf(nullptr, 0, format, arguments);
  va_end(arguments);
  std::string text(length > 0 ? length : 0, '\0');
  // The terminating zero is written where the string has its own.
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  return text;
}

std::string FixedNumber(double value, int decimals) {
  char text[400];  // the largest double has 309 digits
  return {text, std::to_chars(text, text + sizeof(text), value,
                              std::chars_format::fixed, decimals)
                    .ptr};
}

std::string NumberTo(double value, double sigma) {
  if (!(sigma > 0.0)) return Format("%.6g", value);
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(sigma)));
  return FixedNumber(value, std::clamp(decimals, 0, 9));
}

std::string ShortNumber(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof(text), value,
                              std::chars_format::general)
                    .ptr};
}

std::string Base64(const std::string& bytes) {
  constexpr char kDigits[] =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k) {
      const size_t at = i + k;
      bits =
          bits << 8 | (at < bytes.size() ? static_cast<uint8_t>(bytes[at]) : 0);
    }
    for (size_t k = 0; k < 4; ++k) {
      text += i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
    }
  }
  return text;
}

}  // namespace rgbd_pose
