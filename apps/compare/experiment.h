#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apps/pipeline/settings.h"

namespace rgbd_pose {

// Features only: pixels would hide the effect of M-estimators on wrong matches.
inline OdometrySettings ByFeatures() {
  OdometrySettings settings;
  settings.tracker = "features";
  return settings;
}

// The output folder of a comparison.
class CompareOutput {
 public:
  explicit CompareOutput(const std::string& folder) : folder_(folder) {}

  // Creates the folder early, before the work starts. Throws InputError.
  void Prepare() const;

  // The report is written last, and an earlier report is removed first. If it
  // is there, all files are from the same comparison.
  void Write(const std::string& file, const std::string& content) const;
  void WriteReport(const std::string& content) const;

 private:
  std::filesystem::path folder_;
};

// The settings of an experiment.
struct ExperimentSettings {
  std::string experiment;  // a name or a folder
  std::string losses;      // comma-separated; empty: default of the experiment
  std::string camera;      // file or preset; empty: ros_default if simulated
  int frames = 150;        // of a simulated sequence
  int seeds = 200;         // of a sweep, per share of wrong matches
  OdometrySettings odometry = ByFeatures();  // all but the loss
};

// The result: report.md, and whether enough frames were tracked to compare.
struct ExperimentResult {
  std::string report;
  bool is_usable = true;
};

// A way to compare M-estimators: one file and one row of experiment.cc.
struct Experiment {
  std::string_view name;                 // value of --experiment
  std::vector<std::string> (*losses)();  // default losses

  // Writes all files except the report. For invalid settings, throws InputError
  // before writing anything.
  ExperimentResult (*run)(const ExperimentSettings& settings,
                          const std::vector<std::string>& losses,
                          CompareOutput* output);
};

// Runs the experiment of that name, or, if it is a folder, the experiment on a
// recorded sequence. Throws InputError for other names and unknown losses.
ExperimentResult RunExperiment(const ExperimentSettings& settings,
                               CompareOutput* output);

// The functions of the rows, in files of their names.
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
