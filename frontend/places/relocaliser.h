#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/frame.h"
#include "frontend/places/keyframe.h"
#include "frontend/places/place_database.h"
#include "frontend/places/place_features.h"

namespace rgbd_pose {

// Where a lost frame was found again.
struct Relocalisation {
  int keyframe = 0;  // its id; of FindInMap: as the index has it
  Rigid3d cur_from_keyframe;
  int inliers = 0;  // matches that agree with the motion
};

// Finds a frame again among keyframes, without a guess: see
// VerifyGeometrically.
//
// Keyframes are described as they are first looked at, a few in each search, so
// that a search takes some tens of milliseconds at most. The same calls give
// the same results. One object serves one thread.
class Relocaliser {
 public:
  explicit Relocaliser(const Camera& camera,
                       const DepthLookupOptions& depth_options)
      : camera_(camera), depth_options_(depth_options) {}

  // Looks for the frame among keyframes (the latest first): in the latest and
  // in some more, others in each call. Nothing if it is not found among them.
  std::optional<Relocalisation> Find(const Frame& frame,
                                     const std::vector<Keyframe*>& keyframes);

  // Looks for the frame in a whole map: of the keyframes of the index that are
  // most like it, whose features the caller has, the one most matches agree to.
  std::optional<Relocalisation> FindInMap(
      const Frame& frame, const PlaceDatabase& index,
      const std::function<const PlaceFeatures&(int keyframe)>& features_of)
      const;

 private:
  Camera camera_;
  DepthLookupOptions depth_options_;
  int latest_id_ = -1;  // of the keyframes of the last Find
  size_t next_ = 1;     // of them, for the next Find
};

}  // namespace rgbd_pose
