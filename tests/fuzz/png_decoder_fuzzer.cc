// Our own decoder of PNG files.

#include "frontend/sources/png_decoder.h"
#include "tests/fuzz/fuzz_input.h"
#include "tests/support/png_parts.h"

namespace {

using rgbd_pose::Require;

void Decode(std::string_view bytes) {
  const cv::Mat gray = rgbd_pose::DecodePngToGray(bytes);
  const cv::Mat depth = rgbd_pose::DecodePngDepth(bytes);
  Require(gray.empty() || gray.type() == CV_8UC1, "gray values");
  Require(depth.empty() || depth.type() == CV_16UC1, "raw depths");
  Require(!rgbd_pose::IsDamagedPng(bytes) || (gray.empty() && depth.empty()),
          "nothing of a damaged file");
}

// Checksums would keep a fuzzer out, so bytes also become the rows of files
// whose checksums are right: a width, then the rows with their filters.
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
  Require(rgbd_pose::IsDamagedPng(file) != are_filters,
          "damaged just where a filter is none");
  Decode(file);
}

}  // namespace

int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view bytes = rgbd_pose::FuzzText(data, size);
  Decode(bytes);
  if (bytes.empty()) return 0;
  DecodeAsRows(bytes, /*is_depth=*/false);
  DecodeAsRows(bytes, /*is_depth=*/true);
  return 0;
}
