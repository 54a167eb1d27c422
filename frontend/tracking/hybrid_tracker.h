#pragma once

#include <memory>
#include <string>

#include "frontend/tracking/direct_tracker.h"
#include "frontend/tracking/feature_tracker.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// Features first, from where coarse images lead; from there direct costs
// against the same reference, for their accuracy. Where features are few or
// fail, direct costs alone.
class HybridTracker final : public Tracker {
 public:
  static constexpr char kName[] = "hybrid";  // as programs take it

  // None may be null; both of the same camera. Unless it `refines`, pixels only
  // say where to begin, and the motion is that of features.
  HybridTracker(std::unique_ptr<FeatureTracker> features,
                std::unique_ptr<DirectTracker> direct, bool refines);

  void Prepare(const PreparedFrame& frame) const override;
  std::unique_ptr<Reference> MakeReference(const PreparedFrame& frame,
                                           const Reference* last,
                                           const TrackingResult* tracked,
                                           std::string* why_not) override;
  void Track(const Reference& reference, const PreparedFrame& frame,
             const TrackingGuess& guess, TrackingResult* tracked) override;
  void OnAccepted(Reference* reference, TrackingResult* tracked) override;
  const FrontendOptions& images() const override { return features_->images(); }

 private:
  std::unique_ptr<FeatureTracker> features_;
  std::unique_ptr<DirectTracker> direct_;
  bool refines_;
  TrackingResult pixels_;  // by direct costs, from features' motion
  TrackingResult alone_;   // by direct costs, from the guess
};

}  // namespace rgbd_pose
