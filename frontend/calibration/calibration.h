#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "costs/calibration/calibration_parameters.h"
#include "frontend/calibration/calibration_data.h"
#include "frontend/calibration/calibration_result.h"
#include "frontend/settings/settings.h"
#include "frontend/slam/keyframe_map.h"

namespace rgbd_pose {

// How a camera is calibrated from its own recording.
struct CalibrationSettings {
  // Comma-separated names of parameters that keep their value. Some names stand
  // for several: focal, centre, distortion, readouts, registration.
  std::string fix;

  // A known length: two times (s) and the distance between the camera positions
  // at these times (m), as T0,T1,METRES; empty: none.
  std::string known_length;

  // A parameter counts as determined if the recording reduces its standard
  // deviation below this share of the prior's.
  double determined_share = 0.3;

  // Minimum gain of another camera on held-out pairs, as a share of their cost.
  double min_gain = 0.01;

  // The maximum difference of the halves' calibrations, standard deviations.
  double max_halves_sigmas = 4.0;

  // The maximum number of frames per second; 0: all. Ignored if a part of the
  // recording was requested. Velocities, which tell readouts and the delay,
  // need near frames: at 15 per second they are 2 % too small.
  double max_rate = 60.0;

  // The maximum number of passes (mapping and calibration).
  int max_passes = 3;

  // Approximate number of landmark views. The time to solve grows with it.
  int max_views = 40000;

  // Returns one line that says what is wrong with the settings, or empty.
  std::string Check() const;
};

// The rows of these settings.
std::vector<Setting> SettingTable(CalibrationSettings* settings);

// Calibrates a camera from the keyframes and keyframe pairs of its recording,
// tracked with the camera `first`. `path`: see CollectCalibrationData. `known`
// is the camera that the priors are centred on; null means `first`. In a
// further pass over the same recording it is the camera of the first pass, and
// `found_earlier` are the parameters that earlier passes determined.
// `on_iteration` is called after each iteration of the solver; what it throws
// ends the calibration. Throws InputError for invalid settings.
CalibrationResult Calibrate(const KeyframeMap& map, const Trajectory& path,
                            const RgbdCamera& first,
                            const OdometrySettings& odometry,
                            const CalibrationSettings& settings,
                            const CalibrationScale& scale, int threads,
                            const RgbdCamera* known = nullptr,
                            const FreeParts& found_earlier = {},
                            const std::function<void()>& on_iteration = {});

// Which parameters are free: all but those that `fix` names (see
// CalibrationSettings), depth_factor only if the scale is known, distortion
// coefficients only of this lens. Throws InputError for an unknown name.
FreeParts FreeParameters(const std::string& fix, bool has_scale,
                         LensModel lens);

// Returns the first camera, changed by theta.
RgbdCamera ApplyCalibration(const RgbdCamera& first,
                            const CalibrationVector& theta);

// Returns the theta that turns the first camera into `changed`.
CalibrationVector ThetaBetween(const RgbdCamera& first,
                               const RgbdCamera& changed);

// A camera's parameters as in its file; the depth factor relative to `first`.
CalibrationVector CameraValues(const RgbdCamera& first,
                               const RgbdCamera& changed);

}  // namespace rgbd_pose
