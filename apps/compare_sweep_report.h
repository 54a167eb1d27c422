#pragma once

#include <string>
#include <vector>

#include "apps/compare_sweep.h"

namespace rgbd_pose {

// sweep.csv: a header and one row a cell.
std::string SweepCsv(const std::vector<SweepCell>& cells);

// Median translation errors (mm) with their 95 % bands of the graduated losses
// that start from no motion: one row a loss, one column a share.
std::string SweepTable(const std::vector<SweepCell>& cells);

// Curves of the median errors over the share of wrong matches, one panel a
// loss, with 95 % bands; in rotation or in translation. SVG.
std::string SweepFigure(const std::vector<SweepCell>& cells, bool rotation);

// What the sweep says, in words and its own figures: which M-estimator, by how
// much, with what spread, and what RANSAC adds.
std::string SweepVerdict(const std::vector<SweepCell>& cells);

}  // namespace rgbd_pose
