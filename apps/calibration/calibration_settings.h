#pragma once

#include <array>
#include <string>
#include <vector>

#include "apps/pipeline/settings.h"
#include "costs/calibration/calibration_parameters.h"

namespace rgbd_pose {

// How a camera is calibrated from its own recording.
struct CalibrationSettings {
  // Names of parameters that stay as they are, separated by commas; a name may
  // stand for several: focal, centre, distortion, readouts, registration.
  std::string fix;

  // A length that is known: two times (s) and how far apart the camera was then
  // (m), as T0,T1,METRES; empty: none.
  std::string known_length;

  // A parameter is determined by the recording if its standard deviation falls
  // to this share of what it was before.
  double determined_share = 0.3;

  // Another camera has to fit held-out pairs so much better (a share of their
  // cost).
  double min_gain = 0.01;

  // What both halves of a recording say by themselves may differ by so many
  // standard deviations.
  double max_halves_sigmas = 4.0;

  // Of a recording with more frames a second every second one is left out, or
  // more, unless a part of it was asked for: near ones tell the same. 0: none.
  double max_rate = 20.0;

  // A recording is mapped and calibrated so many times at most.
  int max_passes = 3;

  // Views of landmarks, about: the time that a solution takes grows with it.
  int max_views = 40000;

  // One line that says what is wrong with the settings, or empty.
  std::string Check() const;
};

// Their rows.
std::vector<Setting> SettingTable(CalibrationSettings* settings);

// Which parameters are free: all but what `fix` names (see
// CalibrationSettings), depth_factor only where something gives a scale, and of
// the distortion what such a lens has. Throws InputError for a name that there
// is not.
std::array<bool, kCalibrationSize> FreeParameters(const std::string& fix,
                                                  bool has_scale,
                                                  LensModel lens);

}  // namespace rgbd_pose
