#pragma once

#include <memory>
#include <string>
#include <utility>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/util/text_hash.h"
#include "frontend/frame/frame.h"
#include "frontend/frame/prepared_frame.h"
#include "frontend/places/place_features.h"

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

// A frame that others are tracked against, or that a map keeps, and where it
// was taken. Copies share its images and what is made of them.
struct Keyframe {
  int id = 0;              // its name: what edges refer to
  int segment = 0;         // poses of one segment share one world
  Rigid3d world_from_cam;  // of its segment; in a map, of its part of the map

  // Its images, grey and depth: as they are, and packed. One may be empty.
  PreparedFrame frame = {};
  StoredImages images = {};

  // What the uncertainty of its velocity, and of when it was seen, adds to that
  // of motions from it.
  MotionMatrix timing_covariance = MotionMatrix::Zero();

  // What it looks like; null: not described yet.
  std::shared_ptr<const PlaceFeatures> features = nullptr;

  // Its images, unpacked where they have to be. Throws InputError if they are
  // damaged.
  PreparedFrame Unpacked() const {
    return frame.gray.empty() ? PreparedFrame(images.Restore()) : frame;
  }
};

}  // namespace rgbd_pose
