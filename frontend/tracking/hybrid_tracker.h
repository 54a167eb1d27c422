#pragma once

#include <memory>
#include <string>

#include "frontend/tracking/direct_tracker.h"
#include "frontend/tracking/feature_tracker.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// Tracks features first, starting from the alignment of coarse images. Direct
// costs against the same reference then refine the motion for accuracy. If
// there are few features or they fail, direct costs are used alone.
class HybridTracker final : public Tracker {
 public:
  // Neither may be null; both must have the same camera. If `refines` is false,
  // pixels only provide the start, and features alone provide the motion.
  HybridTracker(std::unique_ptr<FeatureTracker> features,
                std::unique_ptr<DirectTracker> direct, bool refines);

  void Prepare(const PreparedFrame& frame) const override {
    features_->Prepare(frame);
    direct_->Prepare(frame);
  }
  std::unique_ptr<Reference> MakeReference(const PreparedFrame& frame,
                                           const Reference* last,
                                           const TrackingResult* tracked,
                                           std::string* why_not) override;
  void MoveReference(const PreparedFrame& frame,
                     const Rigid3d& reference_from_stamp,
                     Reference* reference) const override;
  std::optional<Rigid3d> AlignCoarsely(const PreparedFrame& prev,
                                       const PreparedFrame& cur,
                                       const Rigid3d& cur_from_prev_start,
                                       bool has_shutter) override;
  void Track(const Reference& reference, const PreparedFrame& frame,
             const TrackingGuess& guess, TrackingResult* tracked) override;
  void TrackAgain(const Reference& reference, const PreparedFrame& frame,
                  const TrackingGuess& guess, TrackingResult* tracked) override;
  void Refine(const Reference& reference, const PreparedFrame& frame,
              const TrackingGuess& guess, TrackingResult* tracked) override;
  void OnAccepted(Reference* reference, TrackingResult* tracked) override;
  const FrontendOptions& images() const override { return features_->images(); }

 private:
  // Lets pixels refine or replace the motion of the features in `tracked`.
  void AddPixels(const Reference& reference, const PreparedFrame& frame,
                 const TrackingGuess& guess, TrackingResult* tracked);
  // Refines the motion of the features by pixels. Returns false, and changes
  // only time and iterations, if pixels contradict it or determine none.
  bool RefineByPixels(const Reference& reference, const PreparedFrame& frame,
                      TrackingResult* tracked);
  // Compares a motion from few features with that of pixels alone: ok if they
  // agree. The motion of pixels is taken if they disagree or the other one is
  // not refined. Changes nothing if pixels alone are not ok. `is_refined`:
  // result of RefineByPixels.
  void Confirm(const Reference& reference, const PreparedFrame& frame,
               const TrackingGuess& guess, bool is_refined,
               TrackingResult* tracked);

  std::unique_ptr<FeatureTracker> features_;
  std::unique_ptr<DirectTracker> direct_;
  bool refines_;
  TrackingResult pixels_;  // by direct costs, from the motion of the features
  TrackingResult alone_;   // by direct costs, from the guess
};

}  // namespace rgbd_pose
