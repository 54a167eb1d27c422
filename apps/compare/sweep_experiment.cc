// Compares losses, schedules and starts on wrong matches.

#include "apps/compare/compare_sweep.h"
#include "apps/compare/compare_sweep_report.h"
#include "apps/compare/experiment.h"
#include "apps/shell/program.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
namespace {

constexpr int kMaxSeeds = 100000;

}  // namespace

ExperimentResult RunSweepOfMatches(const ExperimentSettings& settings,
                                   const std::vector<std::string>& losses,
                                   CompareOutput* output) {
  SweepOptions options;
  options.losses = losses;
  options.estimator = settings.odometry.estimator;
  options.seeds = settings.seeds;
  options.threads = AvailableCores();
  if (options.seeds < 1 || options.seeds > kMaxSeeds) {
    throw InputError("--seeds must be 1 to " + std::to_string(kMaxSeeds));
  }
  output->Prepare();
  const std::vector<SweepCell> cells = RunSweep(options);
  output->Write("sweep.csv", SweepCsv(cells));
  output->Write("translation.svg", SweepFigure(cells, /*rotation=*/false));
  output->Write("rotation.svg", SweepFigure(cells, /*rotation=*/true));
  return {"# M-estimators on wrong matches\n\n" + SweepVerdict(cells) +
          "\n\nMedian translation errors (mm) and their 95 % bands over " +
          std::to_string(options.seeds) + " trials of " +
          std::to_string(options.matches) +
          " matches with Kinect noise;\ngraduated losses that start from "
          "identity:\n\n" +
          SweepTable(cells) +
          "\n![Translation errors](translation.svg)\n"
          "![Rotation errors](rotation.svg)\n"};
}

}  // namespace rgbd_pose
