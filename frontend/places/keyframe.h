#pragma once

#include <memory>

#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/prepared_frame.h"
#include "frontend/places/place_features.h"
#include "frontend/places/stored_images.h"

namespace rgbd_pose {

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
