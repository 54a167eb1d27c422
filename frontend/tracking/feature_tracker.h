#pragma once

#include <memory>
#include <string>

#include "core/estimation/estimator.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/feature_trust.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// The features of a frame, and which of them have a say.
class FeatureReference final : public Reference {
 public:
  // One trust for each feature.
  FeatureReference(const Camera& camera, std::unique_ptr<FeatureSet> features,
                   FeatureTrust trust);

  Overlap SeenFrom(const Rigid3d& cur_from_ref) const override;

  // Those it was made with.
  const FeatureSet& features() const { return *features_; }

  FeatureTrust trust;  // in each of them

 private:
  Camera camera_;
  std::unique_ptr<FeatureSet> features_;
};

// Finds the features of the reference again (Frontend) and estimates the motion
// from the matches.
class FeatureTracker final : public Tracker {
 public:
  static constexpr char kName[] = "features";  // as programs take it

  // Throws InputError for options that are not sound (see Check).
  FeatureTracker(std::unique_ptr<Frontend> frontend, Estimator estimator,
                 const TrackerOptions& options = {});

  std::unique_ptr<const PreparedFrame> Prepare(
      const Frame& frame) const override {
    return frontend_->Prepare(frame);
  }
  std::unique_ptr<Reference> MakeReference(const PreparedFrame& frame,
                                           const Reference* last,
                                           const Tracked* tracked,
                                           std::string* why_not) override;
  void Track(const Reference& reference, const PreparedFrame& frame,
             const TrackingGuess& guess, Tracked* tracked) override {
    Track(reference, frame, guess.cur_from_ref, guess, tracked);
  }
  // From a better start than the guess, which only is what the prior is about.
  void Track(const Reference& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_start, const TrackingGuess& guess,
             Tracked* tracked);
  void Believe(Reference* reference, Tracked* tracked) override;
  const FrontendOptions& images() const override {
    return frontend_->options();
  }

 private:
  void Match(const FeatureReference& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_start, Tracked* tracked);
  void Estimate(const Rigid3d& cur_from_ref_start, const MotionPrior& prior,
                Tracked* tracked);
  // Finds the velocity and estimates the motion again, of the same features as
  // they are seen with it.
  void FindTwist(const FeatureSet& features, const Frame& frame,
                 const TrackingGuess& guess, Tracked* tracked);
  // Sets status and reason from the estimate.
  void Judge(Tracked* tracked) const;

  std::unique_ptr<Frontend> frontend_;
  Estimator estimator_;
  TrackerOptions options_;
};

}  // namespace rgbd_pose
