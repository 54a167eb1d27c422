#pragma once

#include <vector>

#include "frontend/features/point_frontend.h"

namespace rgbd_pose {

// Tracks corners of the reference frame directly into each new frame with
// pyramidal Lucas-Kanade (Bouguet 2001), starting at their 3D points projected
// with the guess. Tracking always from the reference prevents drift.
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
