#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apps/pipeline/settings.h"

namespace rgbd_pose {

// Of features alone: pixels would hide what M-estimators do to wrong matches.
inline OdometrySettings ByFeatures() {
  OdometrySettings settings;
  settings.tracker = "features";
  return settings;
}

// The folder that a comparison leaves its files in.
class CompareOutput {
 public:
  explicit CompareOutput(const std::string& folder) : folder_(folder) {}

  // Makes the folder: whether results can be written is better known before
  // the work. Throws InputError.
  void Prepare() const;

  // The report is the last to be written and the first of an earlier one to
  // go: where it is, all is of one comparison.
  void Write(const std::string& file, const std::string& content) const;
  void WriteReport(const std::string& content) const;

 private:
  std::filesystem::path folder_;
};

// What an experiment is run with.
struct ExperimentSettings {
  std::string experiment;  // a name or a folder
  std::string losses;      // separated by commas; empty: the experiment's own
  std::string camera;      // file or preset; empty: ros_default if simulated
  int frames = 150;        // of a simulated sequence
  int seeds = 200;         // of a sweep, at each share of wrong matches
  OdometrySettings odometry = ByFeatures();  // all but the loss
};

// What becomes of it: report.md, and whether enough was tracked to compare.
struct ExperimentResult {
  std::string report;
  bool is_usable = true;
};

// A way to compare M-estimators: one file and one row of experiment.cc.
struct Experiment {
  std::string_view name;                 // as --experiment takes it
  std::vector<std::string> (*losses)();  // where the user names none

  // Writes all files but the report. Throws InputError before anything is
  // written if the settings make no sense.
  ExperimentResult (*run)(const ExperimentSettings& settings,
                          const std::vector<std::string>& losses,
                          CompareOutput* output);
};

// Runs the experiment of that name, or if it is a folder that on a recorded
// sequence. Throws InputError for anything else and for unknown losses.
ExperimentResult RunExperiment(const ExperimentSettings& settings,
                               CompareOutput* output);

// The rows' own, in files of their names.
std::vector<std::string> SequenceLosses();
ExperimentResult RunSimulated(const ExperimentSettings& settings,
                              const std::vector<std::string>& losses,
                              CompareOutput* output);
ExperimentResult RunRecorded(const ExperimentSettings& settings,
                             const std::vector<std::string>& losses,
                             CompareOutput* output);
ExperimentResult RunSweepOfMatches(const ExperimentSettings& settings,
                                   const std::vector<std::string>& losses,
                                   CompareOutput* output);

}  // namespace rgbd_pose
