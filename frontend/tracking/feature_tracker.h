#pragma once

#include <memory>
#include <string>

#include "core/estimation/estimator.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/feature_validation.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// The features of a frame, and which of them have a say.
class FeatureReference final : public Reference {
 public:
  // One trust for each feature.
  FeatureReference(const Camera& camera, std::unique_ptr<FeatureSet> features,
                   FeatureValidation validation);

  Overlap SeenFrom(const Rigid3d& cur_from_ref) const override;

  // Those it was made with.
  const FeatureSet& features() const { return *features_; }

  FeatureValidation validation;  // in each of them

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

  void Prepare(const PreparedFrame& frame) const override {
    frontend_->Prepare(frame);
  }
  std::unique_ptr<Reference> MakeReference(const PreparedFrame& frame,
                                           const Reference* last,
                                           const TrackingResult* tracked,
                                           std::string* why_not) override;
  void Track(const Reference& reference, const PreparedFrame& frame,
             const TrackingGuess& guess, TrackingResult* tracked) override {
    Track(reference, frame, guess.cur_from_ref, guess, tracked);
  }
  // From a better start than the guess, which only is what the prior is about.
  void Track(const Reference& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_start, const TrackingGuess& guess,
             TrackingResult* tracked);
  void OnAccepted(Reference* reference, TrackingResult* tracked) override;
  const FrontendOptions& images() const override {
    return frontend_->options();
  }

 private:
  void Match(const FeatureReference& reference, const PreparedFrame& frame,
             const Rigid3d& cur_from_ref_start, TrackingResult* tracked);
  void Estimate(const Rigid3d& cur_from_ref_start, const MotionPrior& prior,
                TrackingResult* tracked);
  // Where many matches do not agree with the motion but with each other,
  // something moves by itself: the motion of those that are seen in more of the
  // image is taken, and the others are on probation.
  void ChooseMotion(const MotionPrior& prior, TrackingResult* tracked);
  // Finds the velocity and estimates the motion again, of the same features as
  // they are seen with it.
  void FindTwist(const FeatureSet& features, const Frame& frame,
                 const TrackingGuess& guess, TrackingResult* tracked);
  // Sets status and reason from the estimate.
  void Judge(TrackingResult* tracked) const;

  std::unique_ptr<Frontend> frontend_;
  Estimator estimator_;
  TrackerOptions options_;
  TrackingResult other_;  // what the matches that do not agree make of a frame
};

}  // namespace rgbd_pose
