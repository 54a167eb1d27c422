#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"
#include "frontend/frame/prepared_frame.h"
#include "frontend/places/keyframe.h"
#include "frontend/places/place_database.h"
#include "frontend/places/place_features.h"

namespace rgbd_pose {

// Where a lost frame has been relocalised.
struct Relocalisation {
  int keyframe = 0;  // its id; from FindInMap: its number in the index
  Rigid3d cur_from_keyframe;
  int inliers = 0;  // matches that agree with the motion
};

// Relocalises a frame among keyframes without an initial guess (see
// VerifyGeometrically). A keyframe is described when it is first compared, a
// few in each search: some tens of milliseconds at most. The same calls give
// the same results. One object serves one thread.
class Relocaliser {
 public:
  explicit Relocaliser(const FrontendOptions& images) : images_(images) {}

  // Searches the latest keyframe (first in `keyframes`) and a few others,
  // different ones in each call, also if each call comes with one more. Nothing
  // if the frame is not found in these.
  std::optional<Relocalisation> Find(const PreparedFrame& frame,
                                     const std::vector<Keyframe*>& keyframes);

  // Searches one keyframe. Returns false if the frame is not found in it.
  bool FindIn(const PreparedFrame& frame, Keyframe* keyframe,
              Rigid3d* cur_from_keyframe) const;

  // Searches a whole map: of the keyframes most similar according to the index,
  // the one with the most inliers. `features_of`: the features of a keyframe.
  std::optional<Relocalisation> FindInMap(
      const PreparedFrame& frame, const PlaceDatabase& index,
      const std::function<const PlaceFeatures&(int keyframe)>& features_of)
      const;

 private:
  const PlaceFeatures& FeaturesOf(Keyframe* keyframe) const;

  FrontendOptions images_;
  int latest_id_ = -1;  // latest keyframe in the last Find
  size_t next_ = 1;     // where the next Find continues
};

}  // namespace rgbd_pose
