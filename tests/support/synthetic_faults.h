#pragma once

#include <limits>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/rigid3.h"
#include "frontend/simulation/synthetic_dataset.h"
#include "frontend/simulation/synthetic_renderer.h"
#include "frontend/sources/frame_source.h"

namespace rgbd_pose {

// Faults of an RGB-D camera.
enum class FaultKind {
  kBlack,    // the colour image is black
  kCovered,  // the depth image is empty
  kGain,     // gray levels are multiplied by Fault::gain and saturate
  kTurned,   // the camera jumps by kFaultTurnDeg about its y axis
  kBox,      // a printed box circles in front of the camera
  kThinned,  // only every third frame arrives
};

constexpr double kFaultTurnDeg = 25.0;

// A fault of the frames first <= i < end.
struct Fault {
  FaultKind kind = FaultKind::kBlack;
  int first = 0;
  int end = std::numeric_limits<int>::max();  // by default until the last frame
  double gain = 2.0;                          // for kGain
};

// A synthetic sequence with faults. Frames without faults equal those of the
// sequence without faults, byte for byte. Ranges of faults count the frames of
// that sequence, before any are left out. Several faults of one frame are
// applied in their order.
//
// The box is 0.62 x 0.46 x 0.2 m. In its first frame, its front is 0.8 m ahead
// of the camera: 40 % of a 640 x 480 image. Its centre moves on a circle of 0.1
// m radius at 0.3 m/s, upright to and fixed in the axes of that first pose. It
// hides what is farther away in both images, has the sensor's noise if the
// sequence has noise, and is always sharp.
class FaultyDataset : public Dataset {
 public:
  // Throws InputError if options or faults are invalid.
  FaultyDataset(const SyntheticOptions& options, std::vector<Fault> faults);

  int size() const override { return static_cast<int>(source_.size()); }
  double timestamp(int index) const override;
  Frame Read(int index) const override;
  const RgbdCamera& camera() const override { return sound_.camera(); }

  // The frame's index in the sequence without faults.
  int SourceIndex(int index) const { return source_[index]; }

  Rigid3d WorldFromCam(int index) const;

  // The exact pose of every frame.
  Trajectory ground_truth() const override;

 private:
  const SyntheticDataset& Source(int source_index) const;
  void DrawBox(int source_index, int first, Frame* frame) const;

  SyntheticOptions options_;
  std::vector<Fault> faults_;
  SyntheticDataset sound_;
  SyntheticDataset turned_;
  Renderer box_renderer_;
  std::vector<int> source_;  // for each frame left: its index in the sequence
};

}  // namespace rgbd_pose
