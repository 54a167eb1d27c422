#pragma once

#include <string>

#include "frontend/files/yaml_section.h"

namespace rgbd_pose {

// The text of a camera file with its keys spelt as they are read: the keys
// colour_readout and colour_time_offset become color_... . Lines stay.
std::string WithSpellingOfKeys(const std::string& text);

// Throws InputError for a key that was probably meant to be one that is read,
// since without it the camera would silently be another. Returns a remark for
// users on all others that neither this nor the layout's own programs know;
// empty if there are none.
std::string CheckCameraKeys(const YamlSection& file);

// Throws the same InputError for a file of an inertial sensor.
void CheckImuKeys(const YamlSection& file);

}  // namespace rgbd_pose
