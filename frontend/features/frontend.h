#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"
#include "core/geometry/rigid3.h"
#include "frontend/frame/depth_lookup.h"
#include "frontend/frame/prepared_frame.h"

namespace rgbd_pose {

// What all frontends share.
struct FrontendOptions {
  Camera camera;  // of all frames

  // How uncertain a measured depth is.
  DepthNoiseModel depth_noise = *FindDepthNoiseModel("khoshelham");

  // The number of features wanted in a reference frame.
  int max_features = 600;

  // Depths beyond these limits (m) are not used.
  double min_depth = 0.3;
  double max_depth = 8.0;

  // How depths are looked up.
  DepthLookupOptions DepthLookup() const {
    return {depth_noise, min_depth, max_depth};
  }

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The features of one frame, to be found again in others. What else that takes
// (patches, descriptors) is up to the frontend that made it.
class FeatureSet {
 public:
  virtual ~FeatureSet() = default;

  // Where the features are in their own frame. May be refined as more frames
  // see them.
  std::vector<Observation> observations;
};

// Matches between a feature set (prev) and a frame (cur).
struct FeatureMatches {
  Correspondences matches;    // prev: the feature set, cur: the frame
  std::vector<int> features;  // of each match: its place in the feature set

  // Adds a match of feature `i` if Correspondences takes it.
  void Add(const FeatureSet& reference, int i, const Observation& cur) {
    if (matches.Add(reference.observations[i], cur)) features.push_back(i);
  }
  // Adds match `i` of another object of the same feature set.
  void AddFrom(const FeatureMatches& other, size_t i) {
    matches.Add(other.matches[i].prev, other.matches[i].cur);
    features.push_back(other.features[i]);
  }
  // Takes all out; keeps the memory.
  void Clear() {
    matches.Clear();
    features.clear();
  }
};

// Finds the features of one frame again in others. Feature sets are for
// frontends of the type that made them. One object serves one thread.
class Frontend {
 public:
  // The options must be sound (see Check).
  explicit Frontend(const FrontendOptions& options)
      : options_(options), depth_options_(options.DepthLookup()) {}
  virtual ~Frontend() = default;

  // Those it was made with.
  const FrontendOptions& options() const { return options_; }

  // Whether it should find every feature that is in view and not hidden.
  // Detectors need not fire in the same place twice.
  virtual bool is_exhaustive() const { return true; }

  // Makes what will be asked of the frame alone (PreparedFrame::Derived) ahead.
  // May be called from several threads.
  virtual void Prepare(const PreparedFrame& /*frame*/) const {}

  // The features of a frame. They keep copies, if anything, of its images: the
  // caller may write the next ones into the same memory.
  virtual std::unique_ptr<FeatureSet> Detect(const PreparedFrame& frame) = 0;

  // Fills `matches` (emptied first) with the features of `reference` found in
  // `frame`. The guess says where to look for them first.
  virtual void Match(const FeatureSet& reference, const PreparedFrame& frame,
                     const Rigid3d& cur_from_ref_guess,
                     FeatureMatches* matches) = 0;

 protected:
  // Point in camera axes (m) of an observation with a depth.
  Eigen::Vector3d PointOf(const Observation& o) const {
    return options_.camera.Ray(o.u, o.v) * o.depth;
  }

  const FrontendOptions options_;           // as it was made with
  const DepthLookupOptions depth_options_;  // what follows of them for depths
};

// The names of all frontends.
std::vector<std::string> FrontendNames();

// The frontend of that name. Throws InputError listing the names there are, or
// saying what is wrong with the options.
std::unique_ptr<Frontend> MakeFrontend(std::string_view name,
                                       const FrontendOptions& options);

}  // namespace rgbd_pose
