#include <sstream>
#include <string_view>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "frontend/calibration/calibration.h"

namespace rgbd_pose {

std::string CalibrationSettings::Check() const {
  if (!(determined_share > 0.0 && determined_share <= 1.0)) {
    return "determined_share must be above 0 and at most 1";
  }
  if (!(min_gain >= 0.0)) return "min_gain must not be negative";
  if (!(max_halves_sigmas > 0.0)) return "max_halves_sigmas must be positive";
  if (!(max_rate >= 0.0)) return "max_rate must not be negative";
  if (max_passes < 1 || max_passes > 10) return "max_passes must be 1 to 10";
  if (max_views < 1000) return "max_views must be at least 1000";
  try {
    FreeParameters(fix, false, LensModel::kRational);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::vector<Setting> SettingTable(CalibrationSettings* settings) {
  constexpr std::string_view kGroup = "Calibration";
  return {
      {"fix", kGroup,
       "parameters to keep, separated by commas: focal, centre, distortion, "
       "readouts, registration, or single parameter names",
       &settings->fix},
      {"known_length", kGroup,
       "known length that gives depth its scale: T0,T1,METRES, two time stamps "
       "(s) and the distance between the camera positions at these times",
       &settings->known_length},
      {"determined_share", kGroup,
       "a parameter is determined if the recording reduces its standard "
       "deviation to this share of the prior's",
       &settings->determined_share},
      {"min_gain", kGroup,
       "minimum relative decrease of the cost of held-out pairs for a new "
       "camera to be accepted",
       &settings->min_gain},
      {"max_halves_sigmas", kGroup,
       "maximum difference between separate calibrations of the two halves of "
       "a recording, in standard deviations",
       &settings->max_halves_sigmas},
      {"max_rate", kGroup,
       "frames per second that are used at most; from faster recordings frames "
       "are skipped, unless --frames is given; 0: no limit",
       &settings->max_rate},
      {"max_passes", kGroup,
       "maximum number of passes: the recording is mapped again with the "
       "camera found if depth or rows turn out to be displaced by pixels",
       &settings->max_passes},
      {"max_views", kGroup,
       "approximate number of landmark views to solve for; the time grows with "
       "it",
       &settings->max_views},
  };
}

FreeParts FreeParameters(const std::string& fix, bool has_scale,
                         LensModel lens) {
  std::vector<Named<std::vector<int>>> names = {
      {"focal", {kFx, kFy}},
      {"centre", {kCx, kCy}},
      {"distortion", {kK1, kK2, kK3, kK4, kP1, kP2}},
      {"readouts", {kColorReadout, kDepthReadout}},
      {"registration",
       {kRotationX, kRotationY, kRotationZ, kTranslationX, kTranslationY,
        kTranslationZ}},
  };
  for (int k = 0; k < kCalibrationSize; ++k) {
    names.push_back({kCalibrationParameters[k].name, {k}});
  }
  FreeParts is_free;
  is_free.set();
  is_free[kDepthFactor] = has_scale;
  is_free[kK4] = lens == LensModel::kEquidistant;
  is_free[kP1] = is_free[kP2] = lens != LensModel::kEquidistant;
  std::stringstream list(fix);
  for (std::string word; std::getline(list, word, ',');) {
    const auto& row =
        Located("fix", [&] { return RowOf(names, "parameter", word); });
    for (const int part : row.value) is_free[part] = false;
  }
  return is_free;
}

}  // namespace rgbd_pose
