#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/evaluation/truth_alignment.h"

namespace rgbd_pose {

// Lines of the table: the clock and the fixing of the truth that fit best (ms,
// degrees, mm, each with its standard deviation), and the errors there over
// motions of `rpe_delta_seconds`. One line where there is none.
std::string FormatTruthAlignment(const TruthAlignment& alignment,
                                 double rpe_delta_seconds);

// The same for programs; a standard deviation of what is not determined is
// null, as are figures where there is no alignment.
nlohmann::json TruthAlignmentToJson(const TruthAlignment& alignment,
                                    double rpe_delta_seconds);

}  // namespace rgbd_pose
