#pragma once

#include <memory>
#include <string>
#include <utility>

#include "core/util/text_hash.h"
#include "frontend/frame/frame.h"

namespace rgbd_pose {

// The bytes of a PNG file and their checksum. Never changed, so that copies of
// what holds it can share it.
struct PngBytes {
  // The checksum follows.
  explicit PngBytes(std::string file);

  const std::string bytes;     // the whole file
  const std::string checksum;  // of the bytes: TextHash, 16 hexadecimal digits
};

// What a map keeps of a frame: its grey and depth image, compressed without
// loss (VGA: about 0.3 MB instead of 0.9; 5 ms to store, 2 ms to restore), its
// time and its depth scale. Copies share the images.
struct StoredImages {
  // None.
  StoredImages() = default;

  // Of a frame with both images.
  explicit StoredImages(const Frame& frame);

  // The frame, as it was but for its index (0) and colours (none). Throws
  // InputError if the images cannot be decoded.
  Frame Restore() const;

  // One line that says what is wrong, or empty: there are both images, as PNG
  // files of that size (px), with 8 bits of grey and 16 of depth.
  std::string Check(int width, int height) const;

  double timestamp = 0.0;                 // as Frame has it: s
  double depth_delay = 0.0;               // s
  double depth_scale = 5000.0;            // raw units per metre
  std::shared_ptr<const PngBytes> gray;   // 8 bits
  std::shared_ptr<const PngBytes> depth;  // 16 bits
};

}  // namespace rgbd_pose
