#include "apps/compare/experiment.h"

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "core/util/input_error.h"
#include "core/util/text_file.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

constexpr char kReport[] = "report.md";

// All experiments except those on a folder.
const std::vector<Experiment>& Experiments() {
  static const std::vector<Experiment> rows = {
      {"pan_tilt", SequenceLosses, RunSimulated},
      {"xyz", SequenceLosses, RunSimulated},
      {"sweep", MEstimatorNames, RunSweepOfMatches},
  };
  return rows;
}

// The experiment on a folder.
constexpr Experiment kRecorded = {"", SequenceLosses, RunRecorded};

Experiment FindExperiment(const std::string& name) {
  std::string names;
  for (const Experiment& experiment : Experiments()) {
    if (experiment.name == name) return experiment;
    if (!names.empty()) {
      names += &experiment == &Experiments().back() ? " or " : ", ";
    }
    names += experiment.name;
  }
  std::error_code error;
  if (std::filesystem::is_directory(name, error)) return kRecorded;
  throw InputError("--experiment=" + name + " is neither " + names +
                   " nor a folder");
}

std::vector<std::string> ParseLosses(const std::string& text) {
  std::vector<std::string> losses;
  std::istringstream words(text);
  for (std::string loss; std::getline(words >> std::ws, loss, ',');) {
    loss.erase(loss.find_last_not_of(' ') + 1);
    try {
      ParseLoss(loss);
    } catch (const InputError& error) {
      throw InputError(std::string("--losses: ") + error.what());
    }
    if (std::find(losses.begin(), losses.end(), loss) != losses.end()) {
      throw InputError("--losses: '" + loss + "' appears twice");
    }
    losses.push_back(loss);
  }
  if (losses.empty()) throw InputError("--losses contains no names");
  return losses;
}

}  // namespace

void CompareOutput::Prepare() const {
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  if (error) {
    throw InputError("--output=" + folder_.string() + ": cannot be created (" +
                     error.message() + ")");
  }
  RequireWritable(folder_ / kReport);
}

void CompareOutput::Write(const std::string& file,
                          const std::string& content) const {
  std::error_code ignored;
  std::filesystem::remove(folder_ / kReport, ignored);
  WriteFileAtomically(folder_ / file, content);
}

void CompareOutput::WriteReport(const std::string& content) const {
  Write(kReport, content);
}

ExperimentResult RunExperiment(const ExperimentSettings& settings,
                               CompareOutput* output) {
  const Experiment experiment = FindExperiment(settings.experiment);
  return experiment.run(settings,
                        settings.losses.empty() ? experiment.losses()
                                                : ParseLosses(settings.losses),
                        output);
}

}  // namespace rgbd_pose
