#pragma once

#include <string>
#include <vector>

#include "apps/compare/compare_sweep.h"

namespace rgbd_pose {

// sweep.csv: a header and one row per cell.
std::string SweepCsv(const std::vector<SweepCell>& cells);

// Reads sweep.csv. Throws InputError if it is missing, broken or incomplete.
std::vector<SweepCell> ReadSweepCsv(const std::string& path);

// Median translation errors (mm) with their 95 % bands for the graduated losses
// that start from no motion: one row per loss, one column per share.
std::string SweepTable(const std::vector<SweepCell>& cells);

// SVG of the median errors, in rotation or in translation, over the share of
// wrong matches with 95 % bands. It shows all losses, started from no motion,
// in two panels: the graduated and the direct schedule.
std::string SweepFigure(const std::vector<SweepCell>& cells, bool rotation);

// Describes the result of a sweep with its figures: the best M-estimator, its
// margin and spread, and the effect of a start from RANSAC.
std::string SweepVerdict(const std::vector<SweepCell>& cells);

}  // namespace rgbd_pose
