#include "core/util/format.h"

#include <charconv>
#include <clocale>
#include <cmath>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>

namespace rgbd_pose {

std::string Format(const char* format, ...) {
  // With a decimal point, whatever the locale of the program.
  static const locale_t kNeutral =
      newlocale(LC_NUMERIC_MASK, "C", static_cast<locale_t>(nullptr));
  const locale_t before = uselocale(kNeutral);
  va_list arguments;
  va_start(arguments, format);
  char* text = nullptr;
  const int length = vasprintf(&text, format, arguments);
  va_end(arguments);
  uselocale(before);
  if (length < 0) return "";
  const std::unique_ptr<char, void (*)(void*)> owner(text, std::free);
  return {text, static_cast<size_t>(length)};
}

std::string NumberTo(double value, double sigma) {
  if (!(sigma > 0.0)) return Format("%.6g", value);
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(sigma)));
  return Format("%.*f", std::clamp(decimals, 0, 9), value);
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
