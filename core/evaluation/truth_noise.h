#pragma once

#include <string>
#include <string_view>

#include "core/evaluation/trajectory.h"

namespace rgbd_pose {

// Noise of true motions in each direction: 0 for rendered sequences.
struct TruthNoise {
  double translation = 0.0;  // sigma, m
  double rotation = 0.0;     // sigma, rad
  // How the sigmas are known, in words; empty: not at all, so they are 0.
  std::string origin = {};

  // For users: "sigma 2 mm, 0.2 deg, as its file says", "assumed exact".
  std::string InWords() const;
};

// The noise of a truth as the comments at the head of its file (TUM text) tell
// it: by the line "# truth_sigma: 0.002 m 0.2 deg", or by a name that
// TruthNoiseByName knows. Throws InputError (file:line) if the file cannot be
// read or that line has another form.
TruthNoise ReadTruthNoise(const std::string& path);

// The noise of the truth of a public recording that a text names: one of the
// TUM RGB-D benchmark, such as rgbd_dataset_freiburg1_xyz.
TruthNoise TruthNoiseByName(std::string_view text);

// Formats a true path as TUM text, with its noise at the head if it is known.
std::string FormatTruth(const Trajectory& truth, const TruthNoise& noise);

}  // namespace rgbd_pose
