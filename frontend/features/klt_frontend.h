#pragma once

#include <vector>

#include "frontend/features/point_frontend.h"

namespace rgbd_pose {

// Corners of the reference frame, tracked straight into each new frame by
// pyramidal Lucas-Kanade (Bouguet 2001), seeded by projecting their 3D points
// with the guess. Tracking always from the reference keeps tracks from
// drifting.
class KltFrontend final : public PointFrontend {
 public:
  static constexpr char kName[] = "klt";

  using PointFrontend::PointFrontend;

  void Prepare(const PreparedFrame& frame) const override;

 private:
  void Follow(const PreparedFrame& from, const Points& points,
              const PreparedFrame& to, Points* moved, Found* found) override;

  std::vector<float> error_;
};

}  // namespace rgbd_pose
