#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/estimation/estimator.h"
#include "core/estimation/frame_view.h"
#include "frontend/features/frontend.h"
#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// When to believe a motion estimated from pixels.
struct DirectTrackerOptions {
  // A frame is lost if a smaller share of its reference is seen as predicted.
  double min_seen_share = 0.15;

  // A frame is lost if neither grey levels nor depths agree with the reference
  // by this much, for example if something covers the lens. Measured: right
  // motions have 0.4 (half of the image covered) to 0.99 in one of the two,
  // wrong ones -0.4 to 0.1 in both.
  double min_likeness = 0.25;

  // Returns one line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// A reference that keeps the images of its frame for the direct costs.
class DirectReference final : public Reference {
 public:
  // `id`: unique for each reference.
  DirectReference(const PreparedFrame& frame, const FrontendOptions& images,
                  uint64_t id);

  Overlap SeenFrom(const Rigid3d& cur_from_ref) const override {
    return samples_.SeenFrom(cur_from_ref);
  }

  // How similar the reference and a frame look.
  ViewLikeness LikenessTo(const PreparedFrame& cur,
                          const Rigid3d& cur_from_ref) const;

  const FrameView* images() const override { return &view_; }
  // Number of samples: pixels with depth on a grid over the image.
  size_t num_samples() const { return samples_.size(); }

 private:
  cv::Mat depth_;
  std::vector<cv::Mat> pyramid_;
  FrameView view_;
  ViewOverlap samples_;
};

// The estimators of motions from pixels.
struct DirectEstimators {
  // Starts from a guess, with direct costs whose losses have a wide basin.
  Estimator leading;
  // Starts from the result of `leading` or of matches, with direct costs whose
  // losses reject moving objects, and with matches if there are any.
  Estimator refining;
  // Finds a start in coarse images; nothing: the guess is the start.
  std::optional<Estimator> coarse = std::nullopt;
};

// Finds the motion by direct costs alone. It works in rooms without texture,
// but its basin of convergence is some pixels of the coarsest level.
class DirectTracker final : public Tracker {
 public:
  static constexpr char kName[] = "direct";  // name in the programs' options

  // Throws InputError for invalid options (see Check).
  DirectTracker(const FrontendOptions& images, DirectEstimators estimators,
                const TrackerOptions& common = {},
                const DirectTrackerOptions& options = {});

  void Prepare(const PreparedFrame& frame) const override;
  std::unique_ptr<Reference> MakeReference(const PreparedFrame& frame,
                                           const Reference* last,
                                           const TrackingResult* tracked,
                                           std::string* why_not) override;
  void Track(const Reference& reference, const PreparedFrame& frame,
             const TrackingGuess& guess, TrackingResult* tracked) override;
  // Estimates the motion from matches and pixels together, without pixels where
  // features contradict the motion. Starts from the motion of the matches,
  // which is accurate enough for the finest level.
  void Refine(const Reference& reference, const PreparedFrame& frame,
              const MotionPrior& prior, const TrackingResult& by_features,
              TrackingResult* tracked);
  // What a guess says about the motion.
  MotionPrior Prior(const TrackingGuess& guess) const {
    return PriorOf(common_, guess);
  }
  // Returns the motion that aligns the coarse images of reference and frame, as
  // a start for tracking; the guess if they do not determine one.
  Rigid3d FindStart(const Reference& reference, const PreparedFrame& frame,
                    const TrackingGuess& guess);
  const FrontendOptions& images() const override { return images_; }

 private:
  // `timing`: of the frame; `num_levels`: 0: all.
  void Estimate(const Reference& reference, const PreparedFrame& frame,
                const FrameTiming& timing, const Rigid3d& start,
                const TrackingGuess& guess, int num_levels,
                Estimator* estimator, MotionEstimate* estimate) const;
  // Estimates the velocity from the motion, then the motion again with it.
  void FindTwist(const Reference& reference, const PreparedFrame& frame,
                 const TrackingGuess& guess, TrackingResult* tracked);
  static void Begin(TrackingResult* tracked);
  FrameView ViewOf(const PreparedFrame& frame, const FrameTiming& timing,
                   const CellMask* moving) const;
  // Sets everything that follows from the estimate.
  void Judge(const Reference& reference, const PreparedFrame& frame,
             TrackingResult* tracked) const;
  void JudgeMotion(const ViewLikeness& likeness, TrackingResult* tracked) const;

  FrontendOptions images_;
  DirectEstimators estimators_;
  MotionEstimate start_;
  TrackerOptions common_;
  DirectTrackerOptions options_;
  uint64_t last_id_ = 0;  // of references
};

}  // namespace rgbd_pose
