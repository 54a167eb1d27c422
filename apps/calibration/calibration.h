#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "apps/calibration/calibration_data.h"
#include "apps/calibration/calibration_halves.h"
#include "apps/calibration/calibration_noise.h"
#include "apps/pipeline/setting_table.h"
#include "core/evaluation/trajectory.h"
#include "core/geometry/camera.h"
#include "costs/calibration/landmark_problem.h"
#include "frontend/tracking/motion_guess.h"

namespace rgbd_pose {

// How a camera is calibrated from its own recording.
struct CalibrationSettings {
  // Names of parameters that stay as they are, separated by commas; a name may
  // stand for several: focal, centre, distortion, registration.
  std::string fix;

  // A length that is known: two times (s) and how far apart the camera was then
  // (m), as T0,T1,METRES; empty: none.
  std::string known_length;

  // Standard deviations of what the first camera says, see
  // kCalibrationParameters.
  CalibrationVector prior = CalibrationVector::Zero();  // 0: of the table

  // A parameter is determined by the recording if its standard deviation falls
  // to this share of what it was before.
  double determined_share = 0.3;

  // Another camera has to fit held-out pairs so much better (a share of their
  // cost), in so many standard deviations.
  double min_gain = 0.01;
  double min_gain_sigmas = 3.0;

  // What both halves of a recording say by themselves may differ by so many
  // standard deviations.
  double max_halves_sigmas = 4.0;

  // How much later than its stamp depth is known to be (s), beyond what the
  // camera that frames were tracked with says.
  double known_delay = 0.0;

  // Of a recording with more frames a second every second one is left out, or
  // more, unless a part of it was asked for: near ones tell the same. 0: none.
  double max_rate = 20.0;

  // A recording is mapped and calibrated so many times at most.
  int max_passes = 3;

  CalibrationDataOptions data;   // which views
  LandmarkProblemOptions solve;  // how they are explained

  // One line that says what is wrong with the settings, or empty.
  std::string Check() const;
};

// Their rows.
std::vector<Setting> SettingTable(CalibrationSettings* settings);

// What became of one parameter.
struct CalibratedParameter {
  // What the recording says of it.
  enum class Fate {
    kFixed,         // was not asked for, or nothing could tell it
    kUndetermined,  // the recording does not tell it
    kDetermined,
  };
  Fate fate = Fate::kFixed;  // what the recording says of it
  double before = 0.0;       // of the first camera
  double prior = 0.0;        // its standard deviation
  double found = 0.0;        // where the recording would have it
  double sigma = 0.0;        // the standard deviation of that
};

// What is left of a held-out view, px: for pictures.
struct HeldOutResidual {
  double u = 0.0;          // where
  double v = 0.0;          // likewise
  Eigen::Vector2d before;  // with the first camera
  Eigen::Vector2d after;   // with the camera found
};

// What came of a calibration.
struct CalibrationResult {
  // In the order of kCalibrationParameters, about the recording as the first
  // camera has it corrected.
  std::array<CalibratedParameter, kCalibrationSize> parameters;

  // Whether `camera` is to be taken; else it is the first one, and `reason`
  // says in words why.
  bool is_accepted = false;
  std::string reason;
  RgbdCamera camera;

  // Where the recording would have the camera, better or not.
  RgbdCamera found;

  // Of what it was made.
  int keyframes = 0;       // of the largest segment
  int pairs = 0;           // of them
  int held_out_pairs = 0;  // of these
  int landmarks = 0;       // points
  int views = 0;           // of the points

  // Mean robust cost of a held-out view with the first camera and the one that
  // was found, and their difference in its standard deviations.
  double cost_before = 0.0;  // with the first camera
  double cost_after = 0.0;   // with the camera found
  double gain_sigmas = 0.0;  // their difference

  // Spread of residuals with either: px, and in sigmas of the depth noise.
  double pixel_before = 0.0;  // with the first camera
  double pixel_after = 0.0;   // with the camera found
  double depth_before = 0.0;  // with the first camera
  double depth_after = 0.0;   // with the camera found
  std::vector<HeldOutResidual> residuals;

  // How noisy depth is, with the camera to go on with; none: too few depths.
  std::optional<DepthNoiseFit> noise;

  // How far the motions of pairs are from the ground truth (RMSE, m), from the
  // poses that go with either camera; 0: there is none.
  double truth_before = 0.0;  // with the first camera
  double truth_after = 0.0;   // with the camera found

  // What the halves of the recording say of what is determined; may be empty.
  std::vector<HalvesOfParameter> halves;

  // How far depth turned out to be displaced, px (the median of views). If that
  // is much, it is due to be mapped again with the camera found.
  double displacement_px = 0.0;
  int passes = 1;

  // What gave depth its scale, in words; empty: nothing did.
  std::string scale_from;
};

// What else is known of where the camera was; null: nothing.
struct CalibrationScale {
  const Trajectory* ground_truth = nullptr;   // the true path
  const MotionGuess* motion_guess = nullptr;  // wheels, say
};

// Calibrates a camera from keyframes and pairs of its recording. `first`: the
// camera that they were tracked with; `path`: a smooth path of all frames, see
// CollectCalibrationData. Throws InputError for settings that are of no use.
CalibrationResult Calibrate(const KeyframeMap& map, const Trajectory& path,
                            const RgbdCamera& first,
                            const OdometrySettings& odometry,
                            const CalibrationSettings& settings,
                            const CalibrationScale& scale, int threads);

}  // namespace rgbd_pose
