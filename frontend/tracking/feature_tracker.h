#pragma once

#include <memory>
#include <string>
#include <utility>

#include "core/estimation/estimator.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/reference.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// Finds the features of the reference in the frame (see Frontend) and estimates
// the motion from the matches.
class FeatureTracker final : public Tracker {
 public:
  // Throws InputError for invalid options (see Check).
  FeatureTracker(std::unique_ptr<Frontend> frontend, Estimator estimator,
                 const TrackerOptions& options = {});

  void Prepare(const PreparedFrame& frame) const override {
    frontend_->Prepare(frame);
  }
  std::unique_ptr<Reference> MakeReference(const PreparedFrame& frame,
                                           const Reference* last,
                                           const TrackingResult* tracked,
                                           std::string* why_not) override;
  void MoveReference(const PreparedFrame& frame,
                     const Rigid3d& reference_from_stamp,
                     Reference* reference) const override;
  void Track(const Reference& reference, const PreparedFrame& frame,
             const TrackingGuess& guess, TrackingResult* tracked) override;
  void TrackAgain(const Reference& reference, const PreparedFrame& frame,
                  const TrackingGuess& guess, TrackingResult* tracked) override;
  void OnAccepted(Reference* reference, TrackingResult* tracked) override;
  const FrontendOptions& images() const override {
    return frontend_->options();
  }

 private:
  void Estimate(Rigid3d start, TrackingResult* tracked);
  // Handles many matches that contradict the motion but agree with each other:
  // something moves by itself. Takes the motion of the matches that cover more
  // of the image and puts the other matches on probation.
  void ChooseMotion(TrackingResult* tracked);
  // Finds the velocity, and the motion again from features corrected with it.
  void FindTwist(const FeatureSet& features, const Frame& frame,
                 const VelocityPrior& velocity, TrackingResult* tracked);
  // Sets what follows from the estimate.
  void Complete(const ReferenceFeatures& reference,
                TrackingResult* tracked) const;
  // Sets status and reason from the estimate.
  void Judge(TrackingResult* tracked) const;

  std::unique_ptr<Frontend> frontend_;
  Estimator estimator_;
  TrackerOptions options_;
  TrackingResult other_;  // motion of the matches that contradict the first one
};

}  // namespace rgbd_pose
