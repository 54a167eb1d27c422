#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/observe.h"
#include "frontend/frame/prepared_frame.h"

namespace rgbd_pose {

struct DescriptorMethod;

// What all frontends share.
struct FrontendOptions {
  Camera camera;  // of all frames

  DepthLookupOptions depth = {};  // which depths are used, and their noise

  // The number of features wanted in a reference frame.
  int max_features = 600;

  // Factor of the localisation noise that a frontend states for its features.
  double feature_noise = 1.0;

  // Returns one line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The features of one frame, which are to be found in other frames. Each
// frontend adds the data it needs for this (patches, descriptors).
class FeatureSet {
 public:
  virtual ~FeatureSet() = default;

  // Where the features are in their own frame: image points (px, distorted),
  // and what was measured there.
  std::vector<cv::Point2f> points;
  std::vector<Observation> observations;
};

// Matches between a feature set (prev) and a frame (cur).
struct FeatureMatches {
  Correspondences matches;    // prev: the feature set, cur: the frame
  std::vector<int> features;  // index of each match in the feature set

  // Adds a match of feature `i` if Correspondences accepts it.
  void Add(const FeatureSet& reference, int i, const Observation& cur) {
    if (matches.Add(reference.observations[i], cur)) features.push_back(i);
  }
  // Adds match `i` of another object for the same feature set.
  void AddFrom(const FeatureMatches& other, size_t i) {
    matches.Add(other.matches[i].prev, other.matches[i].cur);
    features.push_back(other.features[i]);
  }
  // Removes all matches; keeps the memory.
  void Clear() {
    matches.Clear();
    features.clear();
  }
};

// Finds the features of one frame in other frames. A feature set works only
// with frontends of the type that made it. One object serves one thread.
class Frontend {
 public:
  // The options must be valid (see Check).
  explicit Frontend(const FrontendOptions& options) : options_(options) {}
  virtual ~Frontend() = default;

  // The options given to the constructor.
  const FrontendOptions& options() const { return options_; }

  // Whether it should find every feature that is in view and not hidden. A
  // detector need not fire at the same place again.
  virtual bool is_exhaustive() const { return true; }

  // Precomputes everything that needs the frame alone (see
  // PreparedFrame::Derived). May be called from several threads.
  virtual void Prepare(const PreparedFrame& /*frame*/) const {}

  // Detects the features of a frame. Images needed later are copied: the caller
  // may reuse the memory for the next frame.
  virtual std::unique_ptr<FeatureSet> Detect(const PreparedFrame& frame) = 0;

  // Observes the features of a frame again: its velocity (Frame::twist) is
  // known better now. The motion from the camera at its stamp to the axes that
  // motions to other frames start from is no longer the identity if the stamp
  // has moved.
  void ObserveAgain(const Frame& frame, const Rigid3d& reference_from_stamp,
                    FeatureSet* features) const;

  // Clears `matches` and fills it with the features of `reference` found in
  // `frame`. The guess says where to search first.
  virtual void Match(const FeatureSet& reference, const PreparedFrame& frame,
                     const Rigid3d& cur_from_ref_guess,
                     FeatureMatches* matches) = 0;

 protected:
  // Returns the point (m, camera axes) of an observation with depth.
  Eigen::Vector3d PointOf(const Observation& o) const {
    return options_.camera.Ray(o.u, o.v) * o.depth;
  }

  // Returns the observation of an image point (px, distorted) of a frame.
  Observation ObserveAt(const Frame& frame, const cv::Point2f& point,
                        double sigma_px) const {
    return Observe(frame, options_.camera, point.x, point.y,
                   options_.feature_noise * sigma_px, options_.depth);
  }

  // Adds the feature at an image point of its frame.
  void AddFeature(const Frame& frame, const cv::Point2f& point, double sigma_px,
                  FeatureSet* features) const {
    features->points.push_back(point);
    features->observations.push_back(ObserveAt(frame, point, sigma_px));
  }

  const FrontendOptions options_;  // as given to the constructor
};

// Returns the names of all frontends.
std::vector<std::string> FrontendNames();

// Returns the frontend with this name. Throws InputError with the list of names
// if there is no such frontend, or with the reason if options are invalid.
std::unique_ptr<Frontend> MakeFrontend(std::string_view name,
                                       const FrontendOptions& options);

// Tracks corners with pyramidal Lucas-Kanade (Bouguet 2001), always from the
// reference, which prevents drift.
std::unique_ptr<Frontend> MakeKltFrontend(const FrontendOptions& options);

// Finds corners by aligning small patches coarse to fine (patch.h), warped
// according to depth, surface normal and motion, from a start within some
// pixels (see DirectTracker::FindStart).
std::unique_ptr<Frontend> MakePatchFrontend(const FrontendOptions& options);

// Detects keypoints in every frame and matches them by their descriptors: first
// near the places predicted by the guess, anywhere if too few are found there.
// This is slower than tracking corners, but it needs no good guess and
// tolerates larger changes of scale and view. `method` must outlive it.
std::unique_ptr<Frontend> MakeDescriptorFrontend(
    const FrontendOptions& options, const DescriptorMethod& method);

}  // namespace rgbd_pose
