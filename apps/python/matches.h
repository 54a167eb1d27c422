#pragma once

#include <pybind11/pybind11.h>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "apps/python/arrays.h"
#include "core/estimation/correspondences.h"
#include "core/geometry/camera.h"
#include "core/geometry/depth_noise.h"

namespace rgbd_pose {

// A function that makes an observation from a row of three numbers.
using ToObservation = Observation (*)(const Camera& camera,
                                      const Eigen::Vector3d& row);

// Makes an observation from x, y, z in camera axes (m). z = 0 gives non-finite
// values and no match.
Observation ObservePoint(const Camera& camera, const Eigen::Vector3d& point);

// Makes an observation from an image pixel u, v (px) and a depth (m), 0 if
// missing.
Observation ObservePixel(const Camera& camera, const Eigen::Vector3d& pixel);

// Matches and their row numbers in the given arrays.
struct RowMatches {
  Correspondences matches;
  std::vector<size_t> rows;
};

// Matches as Python gives them: row i of both arrays is match i.
class MatchArrays {
 public:
  // Throws InputError with the names of the arguments unless both arrays, and
  // the normals if they are not None, are (N, 3), and sigma_px is positive.
  MatchArrays(const pybind11::object& prev, const std::string& prev_name,
              const pybind11::object& cur, const std::string& cur_name,
              const pybind11::object& normals_cur, double sigma_px);

  // The number of rows.
  size_t size() const { return prev_.size(); }

  // Makes matches from the valid rows. Needs no GIL.
  RowMatches Make(const Camera& camera, ToObservation to_observation,
                  const DepthNoiseModel& depth_noise) const;

 private:
  NumberArray prev_, cur_;
  std::optional<NumberArray> normals_cur_;
  double sigma_px_;
};

}  // namespace rgbd_pose
