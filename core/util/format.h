#pragma once

#include <string>

namespace rgbd_pose {

// What printf would print.
[[gnu::format(printf, 1, 2)]] std::string Format(const char* format, ...);

// With so many decimals, whatever the locale.
std::string FixedNumber(double value, int decimals);

// With the decimals that a standard deviation leaves two digits of.
std::string NumberTo(double value, double sigma);

// As few digits as tell the number from all others: 0.2, not 0.2000...01.
std::string ShortNumber(double value);

// Bytes as text (RFC 4648).
std::string Base64(const std::string& bytes);

}  // namespace rgbd_pose
