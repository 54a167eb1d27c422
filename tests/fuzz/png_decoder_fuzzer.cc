// The project's own decoder of PNG files.

#include "frontend/files/png_decoder.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/support/png_parts.h"

namespace {

using rgbd_pose::DecodedPng;
using rgbd_pose::DecodePng;
using rgbd_pose::PngUse;
using rgbd_pose::Require;

void Decode(std::string_view bytes) {
  const DecodedPng gray = DecodePng(bytes, PngUse::kGrayAndColor);
  const DecodedPng depth = DecodePng(bytes, PngUse::kDepth);
  for (const DecodedPng* png : {&gray, &depth}) {
    Require(!png->is_damaged || png->image.empty(),
            "nothing of a damaged file");
  }
  if (!gray.image.empty()) {
    Require(gray.image.type() == CV_8UC1, "gray values");
    Require(gray.color.type() == CV_8UC3, "colours");
  }
  Require(depth.image.empty() || depth.image.type() == CV_16UC1, "raw depths");
}

// Checksums would stop a fuzzer. Hence the bytes are also used as rows of files
// with valid checksums: a width, then the rows with their filters.
void DecodeAsRows(std::string_view bytes, bool is_depth) {
  rgbd_pose::PngParts png;
  png.width = 1 + static_cast<uint8_t>(bytes.front()) % 16;
  png.kind = {static_cast<char>(is_depth ? 16 : 8),
              static_cast<char>(is_depth ? 0 : 2), 0, 0, 0};
  const size_t row_bytes = 1 + png.width * (is_depth ? 2 : 3);
  png.height = static_cast<uint32_t>(1 + (bytes.size() - 1) / row_bytes);
  png.rows = bytes.substr(1);
  png.rows.resize(png.height * row_bytes);
  bool are_filters = true;
  for (size_t i = 0; i < png.rows.size(); i += row_bytes) {
    are_filters &= static_cast<uint8_t>(png.rows[i]) <= 4;
  }
  const std::string file = png.File();
  Require(
      DecodePng(file, is_depth ? PngUse::kDepth : PngUse::kGray).is_damaged !=
          are_filters,
      "damaged just where a filter is none");
  Decode(file);
}

}  // namespace

FUZZ_TARGET(png_decoder) {
  const std::string_view bytes = rgbd_pose::FuzzText(data, size);
  Decode(bytes);
  if (bytes.empty()) return 0;
  DecodeAsRows(bytes, /*is_depth=*/false);
  DecodeAsRows(bytes, /*is_depth=*/true);
  return 0;
}
