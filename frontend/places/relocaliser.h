#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <optional>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/image/depth_lookup.h"
#include "frontend/image/frame.h"

namespace rgbd_pose {

// Where a lost frame was found again.
struct Relocalisation {
  int keyframe_id = 0;
  Rigid3d cur_from_keyframe;
  int inliers = 0;  // matches that agree with the motion
};

// Finds a frame again among keyframes, without a guess: ORB features (Rublee et
// al. 2011) of both are matched by their descriptors, the motion by random
// samples (core/initial_guess/ransac.h). Accepts only what chance cannot bring
// about; the motion is good enough to track from, not more.
//
// Keyframes cost a copy of their images until they are first looked at; they
// are described then, a few in each search, so that a search takes some tens
// of milliseconds at most. The same calls give the same results. One object
// serves one thread.
class Relocaliser {
 public:
  explicit Relocaliser(const Camera& camera,
                       const DepthLookupOptions& depth_options = {});
  ~Relocaliser();
  Relocaliser(Relocaliser&&) noexcept;
  Relocaliser& operator=(Relocaliser&&) noexcept;

  // Keeps a keyframe under an id of the caller's; the oldest makes way.
  void Add(const Frame& keyframe, int id);

  // Looks for the frame, in the latest keyframe first and in some more, others
  // in each call. Nothing if it is not found among them.
  std::optional<Relocalisation> Find(const Frame& frame);

 private:
  struct Place;

  Camera camera_;
  DepthLookupOptions depth_options_;
  std::deque<std::unique_ptr<Place>> places_;  // the latest first
  size_t next_ = 0;                            // of places_, for the next Find
};

}  // namespace rgbd_pose
