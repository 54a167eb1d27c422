#include "apps/compare/experiment.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "core/util/input_error.h"
#include "core/util/named_values.h"
#include "core/util/text_file.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

constexpr char kReport[] = "report.md";

// All experiments except that on a folder, RunRecorded.
constexpr Named<decltype(&RunSimulated)> kExperiments[] = {
    {"pan_tilt", RunSimulated},
    {"xyz", RunSimulated},
    {"sweep", RunSweepOfMatches},
};

}  // namespace

void PrepareOutput(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) {
    throw InputError("--output=" + folder + ": cannot be created (" +
                     error.message() + ")");
  }
  RequireWritable(std::filesystem::path(folder) / kReport);
}

void WriteOutput(const std::string& folder, const std::string& file,
                 const std::string& content) {
  const std::filesystem::path path(folder);
  std::error_code ignored;
  std::filesystem::remove(path / kReport, ignored);
  WriteFileAtomically(path / file, content);
}

ExperimentResult RunExperiment(const ExperimentSettings& settings,
                               const std::string& output) {
  const std::string& name = settings.experiment;
  if (const auto* found = FindNamed(kExperiments, name)) {
    return found->value(settings, output);
  }
  std::error_code error;
  if (std::filesystem::is_directory(name, error)) {
    return RunRecorded(settings, output);
  }
  std::string names = Join(NamesOf(kExperiments));
  names.replace(names.rfind(", "), 2, " or ");
  throw InputError("--experiment=" + name + " is neither " + names +
                   " nor a folder");
}

std::vector<std::string> ChosenLosses(const ExperimentSettings& settings,
                                      const std::vector<std::string>& own) {
  if (settings.losses.empty()) return own;
  std::vector<std::string> losses;
  for (const std::string& loss : SplitList(settings.losses)) {
    Located("--losses", [&] { ParseLoss(loss); });
    if (std::find(losses.begin(), losses.end(), loss) != losses.end()) {
      throw InputError("--losses: '" + loss + "' appears twice");
    }
    losses.push_back(loss);
  }
  return losses;
}

}  // namespace rgbd_pose
