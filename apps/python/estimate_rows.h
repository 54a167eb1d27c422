#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "apps/python/arrays.h"
#include "core/estimation/correspondences.h"
#include "core/estimation/motion_estimate.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"

// Between the rows of Python's arrays and the matches of an estimate. Nothing
// here needs the GIL.

namespace rgbd_pose {

// What a camera has seen, from a row of three numbers.
using ToObservation = Observation (*)(const Camera& camera,
                                      const Eigen::Vector3d& row);

// From x, y, z in camera axes (m). z = 0 gives no numbers: no match.
Observation ObservePoint(const Camera& camera, const Eigen::Vector3d& point);

// From an image pixel u, v (px) and a depth (m), 0 where none was measured.
Observation ObservePixel(const Camera& camera, const Eigen::Vector3d& pixel);

// Matches and the rows of the given arrays that they are.
struct RowMatches {
  Correspondences matches;
  std::vector<size_t> rows;
};

// The matches of rows that make one. `normals_cur` may be null.
RowMatches MakeMatches(const Camera& camera, ToObservation to_observation,
                       const NumberArray& prev, const NumberArray& cur,
                       const NumberArray* normals_cur, double sigma_px,
                       const DepthNoiseModel& depth_noise);

// An estimate whose lists hold one entry for each row that was given, accepted
// as a match or not.
struct EstimateResult {
  MotionEstimate estimate;
  std::vector<uint8_t> is_inlier;
  size_t num_rejected = 0;
};

// The result of an estimate from `matches`, of `size` rows.
EstimateResult MakeResult(MotionEstimate estimate, const RowMatches& matches,
                          size_t size);

}  // namespace rgbd_pose
