#pragma once

#include <string>
#include <vector>

#include "frontend/settings/settings.h"

namespace rgbd_pose {

// Creates the output folder before the work starts. Throws InputError.
void PrepareOutput(const std::string& folder);

// Writes a file into it. An earlier report is removed first: if report.md,
// which is written last, is there, all files are from the same comparison.
void WriteOutput(const std::string& folder, const std::string& file,
                 const std::string& content);

struct ExperimentSettings {
  // Pixels would hide the effect of M-estimators on wrong matches.
  ExperimentSettings() { odometry.tracker = "features"; }

  std::string experiment;  // a name or a folder
  std::string losses;      // comma-separated; empty: default of the experiment
  std::string camera;      // file or preset; empty: ros_default if simulated
  int frames = 150;        // of a simulated sequence
  int seeds = 200;         // of a sweep, per share of wrong matches
  OdometrySettings odometry;  // all but the loss
};

// The result: report.md, and whether enough frames were tracked to compare.
struct ExperimentResult {
  std::string report;
  bool is_usable = true;
  bool has_stopped = false;  // a recording ended early, see FrameStream
};

// Runs the experiment of that name or on the recording in that folder. `output`
// is the output folder. Throws InputError for other names and unknown losses.
ExperimentResult RunExperiment(const ExperimentSettings& settings,
                               const std::string& output);

// The losses to compare: those of the settings, or else the experiment's own.
// Throws InputError for unknown names and for names that come twice.
std::vector<std::string> ChosenLosses(const ExperimentSettings& settings,
                                      const std::vector<std::string>& own);

// The ways to compare M-estimators, one row of experiment.cc each. They write
// all but the report, and throw InputError for invalid settings before that.
ExperimentResult RunSimulated(const ExperimentSettings& settings,
                              const std::string& output);
ExperimentResult RunRecorded(const ExperimentSettings& settings,
                             const std::string& output);
ExperimentResult RunSweepOfMatches(const ExperimentSettings& settings,
                                   const std::string& output);

}  // namespace rgbd_pose
