#pragma once

#include <string>
#include <vector>

#include "apps/compare/compare_sweep.h"

namespace rgbd_pose {

// sweep.csv: a header and one row a cell.
std::string SweepCsv(const std::vector<SweepCell>& cells);

// Reads it again. Throws InputError if it is missing, broken or incomplete.
std::vector<SweepCell> ReadSweepCsv(const std::string& path);

// Median translation errors (mm) with their 95 % bands of the graduated losses
// that start from no motion: one row a loss, one column a share.
std::string SweepTable(const std::vector<SweepCell>& cells);

// Curves of the median errors over the share of wrong matches, with 95 % bands,
// of all losses together: graduated in one panel, at once in the other, both
// from no motion; in rotation or in translation. SVG.
std::string SweepFigure(const std::vector<SweepCell>& cells, bool rotation);

// What a sweep says, in words and its own figures: which M-estimator, by how
// much, with what spread, and what a start from RANSAC changes.
std::string SweepVerdict(const std::vector<SweepCell>& cells);

}  // namespace rgbd_pose
