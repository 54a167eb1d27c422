#pragma once

#include <string>

#include "core/geometry/depth_noise.h"

namespace rgbd_pose {

// The text of a YAML file for a depth noise model, with the fields constant
// (m), quadratic (1/m), centre (m) and mean_share of DepthNoiseModel as keys.
std::string FormatDepthNoiseFile(const DepthNoiseModel& model);

// Reads such a file; the path becomes the name of the model. centre and
// mean_share default to 0 and 1. Errors (InputError) name file, line and key.
DepthNoiseModel ReadDepthNoiseFile(const std::string& path);

// The model of this name or file. Otherwise throws InputError with all names.
DepthNoiseModel ResolveDepthNoise(const std::string& name_or_file);

}  // namespace rgbd_pose
