#pragma once

#include <memory>
#include <string>

#include "frontend/tracking/tracker.h"

namespace rgbd_pose {

// A tracker that does nothing; tests override what they observe.
class FakeTracker : public Tracker {
 public:
  void Prepare(const PreparedFrame& /*frame*/) const override {}
  std::unique_ptr<Reference> MakeReference(const PreparedFrame& /*frame*/,
                                           const Reference* /*last*/,
                                           const TrackingResult* /*tracked*/,
                                           std::string* /*why_not*/) override {
    return std::make_unique<Reference>();
  }
  void MoveReference(const PreparedFrame& /*frame*/,
                     const Rigid3d& /*reference_from_stamp*/,
                     Reference* /*reference*/) const override {}
  void Track(const Reference& /*reference*/, const PreparedFrame& /*frame*/,
             const TrackingGuess& /*guess*/,
             TrackingResult* /*tracked*/) override {}
  void TrackAgain(const Reference& /*reference*/,
                  const PreparedFrame& /*frame*/,
                  const TrackingGuess& /*guess*/,
                  TrackingResult* /*tracked*/) override {}
  const FrontendOptions& images() const override { return images_; }

 protected:
  FrontendOptions images_;
};

}  // namespace rgbd_pose
