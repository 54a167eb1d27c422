#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <vector>

#include "frontend/features/frontend.h"

namespace rgbd_pose {

// A frontend whose features are image points. What remains to be said is where
// they have moved to, and perhaps which they are; depth, its noise and
// distortion are seen to here.
class PointFrontend : public Frontend {
 public:
  using Frontend::Frontend;

  std::unique_ptr<FeatureSet> Detect(const PreparedFrame& frame) final;
  void Match(const FeatureSet& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_guess, FeatureMatches* matches) final;

 protected:
  using Points = std::vector<cv::Point2f>;  // px, distorted
  using Found = std::vector<uchar>;         // 0: no, else yes

  // The points of a frame to be found again; those without a depth will be left
  // out. Unless overridden, corners with a depth, spread over a grid.
  virtual void Find(const Frame& frame, Points* points);

  // Where `points` of the frame `from`, which has no depth any more, are in the
  // frame `to`. On entry `moved`
  // holds where the guess has them, and all are found. Neither may change its
  // size: Match would throw InputError.
  virtual void Follow(const PreparedFrame& from, const Points& points,
                      const PreparedFrame& to, Points* moved, Found* found) = 0;

 private:
  Observation ObserveAt(const Frame& frame, const cv::Point2f& point) const;

  Points moved_;
  Found found_;
};

}  // namespace rgbd_pose
