#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "core/util/text_hash.h"
#include "frontend/frame/frame.h"
#include "frontend/frame/prepared_frame.h"
#include "frontend/places/place_features.h"

namespace rgbd_pose {

// The bytes of a PNG file and their checksum. Immutable: copies of a
// StoredImages share one object.
struct PngBytes {
  // Computes the checksum.
  explicit PngBytes(std::string_view file)
      : PngBytes(file, TextHash().Add(file).Hex()) {}

  // With a known checksum: a file that is not loaded has no bytes.
  PngBytes(std::string_view file, const std::string& checksum_of_file)
      : bytes(file), checksum(checksum_of_file) {}

  const std::string bytes;     // the whole file
  const std::string checksum;  // TextHash of `bytes`, 16 hexadecimal digits
};

// The images of a frame as a map stores them: grey and depth, compressed
// without loss (VGA: about 0.3 MB instead of 0.9; 5 ms to store, 2 ms to
// restore), with the time stamp and the depth scale. Copies share the images.
struct StoredImages {
  // Holds no images.
  StoredImages() = default;

  // Compresses the images of a frame, which must have both.
  explicit StoredImages(const Frame& frame);

  // Restores the members below. All others (index, colour, shutters, velocity)
  // have their defaults. Throws InputError if the images cannot be decoded.
  Frame Restore() const;

  // One line that says what is wrong, or empty. Both images must be PNG files
  // of this size (px), grey with 8 bits and depth with 16.
  std::string Check(int width, int height) const;

  double timestamp = 0.0;                 // s, as in Frame
  double depth_delay = 0.0;               // s, as in Frame
  double depth_scale = 5000.0;            // raw units per metre
  std::shared_ptr<const PngBytes> gray;   // 8 bits
  std::shared_ptr<const PngBytes> depth;  // 16 bits
};

// A frame that others are tracked against or that a map keeps, with its pose.
// Copies share its images and what is derived from them.
struct Keyframe {
  int id = 0;              // referred to by the edges of the graph
  int segment = 0;         // poses of one segment share one world frame
  Rigid3d world_from_cam;  // world of its segment or of its part of the map

  // The decoded and the compressed images. One of the two may be empty. While
  // frames are tracked against it, the images are as they were exposed, and the
  // pose is that of these axes near the camera at the stamp.
  PreparedFrame frame = {};
  Rigid3d reference_from_stamp = {};
  StoredImages images = {};

  // What the uncertainty of the frame's velocity and capture time adds to the
  // covariance of motions from this frame.
  MotionMatrix timing_covariance = MotionMatrix::Zero();

  // Features for place recognition; null: not computed yet.
  std::shared_ptr<const PlaceFeatures> features = nullptr;

  // The frame with decoded images. Throws InputError if the compressed images
  // have to be decoded and are damaged.
  PreparedFrame Unpacked() const {
    return frame.gray.empty() ? PreparedFrame(images.Restore()) : frame;
  }
};

}  // namespace rgbd_pose
