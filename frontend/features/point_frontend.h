#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/frontend.h"

namespace rgbd_pose {

// A frontend whose features are image points. A subclass has to say where the
// points have moved to, and optionally which points to use. This class handles
// depth, its noise and distortion.
class PointFrontend : public Frontend {
 public:
  using Frontend::Frontend;

  std::unique_ptr<FeatureSet> Detect(const PreparedFrame& frame) final;
  void Match(const FeatureSet& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_guess, FeatureMatches* matches) final;

 protected:
  using Points = std::vector<cv::Point2f>;  // px, distorted
  using Found = std::vector<uchar>;         // 0: no, else yes

  // Finds the points of a frame that are to be tracked. Points without a depth
  // will be left out. By default: corners with a depth, spread over a grid.
  virtual void Find(const Frame& frame, Points* points);

  // Finds `points` of the frame `from`, which has no depth any more, in the
  // frame `to`. On entry `moved` holds the places predicted by the guess, and
  // all points count as found. Match throws InputError if sizes change.
  virtual void Follow(const PreparedFrame& from, const Points& points,
                      const PreparedFrame& to, Points* moved, Found* found) = 0;
};

}  // namespace rgbd_pose
