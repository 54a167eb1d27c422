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

// What is believed of a motion that is estimated from pixels.
struct DirectTrackerOptions {
  // A frame is lost if less of its reference is seen where it should be.
  double min_seen_share = 0.15;

  // It is lost if neither gray levels nor depths of more than this agree with
  // those of its reference, as where something covers the lens. Measured: right
  // motions have 0.4 (half of the image covered) to 0.99 of one of the two,
  // wrong ones -0.4 to 0.1 of both.
  double min_likeness = 0.25;

  // One line that says what is wrong with the options, or empty.
  std::string Check() const;
};

// The images of a frame that direct costs look at, kept.
class DirectReference final : public Reference {
 public:
  // `id`: another one for each reference.
  DirectReference(const PreparedFrame& frame, const FrontendOptions& images,
                  uint64_t id);

  Overlap SeenFrom(const Rigid3d& cur_from_ref) const override {
    return samples_.SeenFrom(cur_from_ref);
  }

  // How alike it and a frame look.
  ViewLikeness LikenessTo(const PreparedFrame& cur,
                          const Rigid3d& cur_from_ref) const;

  const FrameView* images() const override { return &view_; }
  // Pixels with depth, of a grid over the image.
  size_t num_samples() const { return samples_.size(); }

 private:
  cv::Mat depth_;
  std::vector<cv::Mat> pyramid_;
  FrameView view_;
  ViewOverlap samples_;
};

// What makes motions of pixels.
struct DirectEstimators {
  // From a guess: of direct costs whose losses have a wide basin.
  Estimator leading;
  // From where these or matches have led: of direct costs whose losses reject
  // what moves by itself, and of matches where there are some.
  Estimator refining;
  // Finds a start in coarse images; nothing: the guess is the start.
  std::optional<Estimator> coarse = std::nullopt;
};

// Finds the motion by direct costs alone: no features, so nothing to be lost in
// a room without texture, but a basin of some pixels of the coarsest level.
class DirectTracker final : public Tracker {
 public:
  static constexpr char kName[] = "direct";  // as programs take it

  // Throws InputError for options that are not sound (see Check).
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
  // Matches and pixels together, but for those where features contradict them,
  // from the motion of the matches, which is good enough for the finest level.
  void Refine(const Reference& reference, const PreparedFrame& frame,
              const TrackingGuess& guess, const TrackingResult& by_features,
              TrackingResult* tracked);
  // The motion that shows the coarse images of the reference in those of the
  // frame: where to begin. The guess itself if they do not tell one.
  Rigid3d FindStart(const Reference& reference, const PreparedFrame& frame,
                    const TrackingGuess& guess);
  const FrontendOptions& images() const override { return images_; }

 private:
  // `timing`: of the frame; `num_levels`: 0: all.
  void Estimate(const Reference& reference, const PreparedFrame& frame,
                const FrameTiming& timing, const Rigid3d& start,
                const TrackingGuess& guess, int num_levels,
                Estimator* estimator, MotionEstimate* estimate) const;
  // Estimates the motion with the velocity that it says itself.
  void FindTwist(const Reference& reference, const PreparedFrame& frame,
                 const TrackingGuess& guess, TrackingResult* tracked);
  static void Begin(TrackingResult* tracked);
  FrameView ViewOf(const PreparedFrame& frame, const FrameTiming& timing,
                   const CellMask* moving) const;
  // Sets all that follows from the estimate.
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
