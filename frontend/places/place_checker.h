#pragma once

#include <memory>
#include <string>

#include "core/estimation/estimator.h"
#include "core/geometry/motion.h"
#include "core/geometry/rigid3.h"
#include "frontend/features/frontend.h"
#include "frontend/places/place_features.h"

namespace rgbd_pose {

// What is asked of two frames that may show the same place.
struct PlaceCheckerOptions {
  // So many matches of the frontend must agree with one motion, in number and
  // as a share of them. Frames that are tracked are asked for less (see
  // TrackerOptions): they have the last pose to go by.
  int min_inliers = 60;
  double min_inlier_share = 0.5;

  // Their residuals must not spread wider than this, in sigmas.
  double max_sigma = 3.0;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// What came of it.
struct PlaceCheck {
  bool ok = false;     // they show the same place, and the motion is this
  std::string reason;  // why not, in words; empty if ok

  Rigid3d cur_from_ref;                            // as estimated
  MotionMatrix covariance = MotionMatrix::Zero();  // as MotionEstimate's
  int num_matches = 0;  // of the frontend, from the rough motion or the guess
  int num_inliers = 0;  // of these, in agreement
  double sigma = 0.0;   // as MotionEstimate's
};

// Says whether two frames show the same place, and the motion between them: as
// an edge of a graph. What it cannot know is whether there are two places that
// look exactly alike; the graph tells by where they are. One object serves one
// thread.
class PlaceChecker {
 public:
  // The frontend must be of the type that made the features. Throws InputError
  // for options that are not sound (see Check).
  PlaceChecker(std::unique_ptr<Frontend> frontend, Estimator estimator,
               const PlaceCheckerOptions& options = {});

  // Without a guess: a rough motion by descriptors (FindRoughMotion), the
  // frontend's own matches from there, the estimate from these. The descriptors
  // that agreed must agree with it, too.
  PlaceCheck Check(const PlaceFeatures& ref_place, const FeatureSet& ref,
                   const PlaceFeatures& cur_place, const PreparedFrame& cur);

  // Where the motion is known well enough to search from.
  PlaceCheck CheckNear(const Rigid3d& cur_from_ref_guess, const FeatureSet& ref,
                       const PreparedFrame& cur);

  // The one it was made with: to detect features, to prepare frames.
  Frontend& frontend() { return *frontend_; }

 private:
  std::unique_ptr<Frontend> frontend_;
  Estimator estimator_;
  PlaceCheckerOptions options_;
  FeatureMatches matches_;
  MotionEstimate estimate_;
};

}  // namespace rgbd_pose
