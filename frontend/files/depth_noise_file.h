#pragma once

#include <string>

#include "core/geometry/depth_noise.h"

namespace rgbd_pose {

// The text of a file with a depth noise model: the keys constant (m), quadratic
// (1/m), centre (m) and mean_share of DepthNoiseModel, in YAML.
std::string FormatDepthNoiseFile(const DepthNoiseModel& model);

// A model of such a file, named as the file is; centre and mean_share may be
// missing (0, 1). Throws InputError naming file, line and key.
DepthNoiseModel ReadDepthNoiseFile(const std::string& path);

// The model of that name, or that of the file there. Throws InputError listing
// the names there are.
DepthNoiseModel ResolveDepthNoise(const std::string& name_or_file);

}  // namespace rgbd_pose
