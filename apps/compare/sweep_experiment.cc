// Compares losses, schedules and starts on wrong matches.

#include <cmath>

#include "apps/compare/compare_sweep.h"
#include "apps/compare/experiment.h"
#include "apps/shell/program.h"
#include "core/initial_guess/consensus.h"
#include "core/util/input_error.h"
#include "core/util/parallel_for.h"
#include "frontend/simulation/synthetic_matches.h"
#include "robust/m_estimator.h"

namespace rgbd_pose {
namespace {

constexpr int kMaxSeeds = 100000;
constexpr int kMatches = 300;  // number of inliers and outliers together

// Typical motion between a reference and a frame tenths of a second later.
constexpr double kMaxAngle = 0.1;        // rad
constexpr double kMaxTranslation = 0.1;  // m, along each axis
constexpr unsigned kFirstSeed = 7000;    // different from the benchmarks' seeds

// The motion that is left between the estimate of each method and the truth.
std::vector<Rigid3d> RunSeed(int seed, double outlier_share,
                             const std::vector<SweepMethod>& methods,
                             std::vector<Estimator>* estimators) {
  RandomWorld world(kFirstSeed + seed);
  const Rigid3d truth = world.Motion(kMaxAngle, kMaxTranslation);
  const Correspondences found = world.Matches(kMatches, outlier_share, truth);
  const Rigid3d ransac =
      FindByRansac(found).value_or(Consensus()).cur_from_prev;
  std::vector<Rigid3d> errors;
  for (size_t i = 0; i < methods.size(); ++i) {
    const Rigid3d guess = methods[i].ransac ? ransac : Rigid3d();
    errors.push_back(
        (*estimators)[i].Estimate(found, guess).cur_from_prev.Inverse() *
        truth);
  }
  return errors;
}

// The errors of all methods at all shares, each on the same matches.
std::vector<SweepCell> RunSweep(EstimatorSettings settings,
                                const std::vector<std::string>& losses,
                                int seeds) {
  const std::vector<SweepMethod> methods = SweepMethods(losses);
  const int threads = AvailableCores();
  // Each thread needs its own estimators.
  std::vector<std::vector<Estimator>> estimators(threads);
  for (std::vector<Estimator>& own : estimators) {
    for (const SweepMethod& method : methods) {
      settings.loss = method.loss;
      settings.options.schedule = method.schedule == "gnc"
                                      ? RobustSchedule::kGnc
                                      : RobustSchedule::kDirect;
      own.push_back(MakeEstimator(settings));
    }
  }
  std::vector<SweepCell> cells(methods.size() * kSweepShares);
  for (int share = 0; share < kSweepShares; ++share) {
    std::vector<std::vector<Rigid3d>> errors(seeds);
    ParallelFor(threads, threads, [&](int thread) {
      for (int seed = thread; seed < seeds; seed += threads) {
        errors[seed] =
            RunSeed(seed, SweepShare(share), methods, &estimators[thread]);
      }
    });
    for (size_t i = 0; i < methods.size(); ++i) {
      std::vector<double> rotations, translations;
      for (const std::vector<Rigid3d>& of_seed : errors) {
        rotations.push_back(of_seed[i].Angle() * 180.0 / M_PI);
        translations.push_back(of_seed[i].translation.norm() * 1e3);
      }
      cells[i * kSweepShares + share] = {methods[i], SweepShare(share),
                                         FindMedianBand(rotations),
                                         FindMedianBand(translations)};
    }
  }
  return cells;
}

}  // namespace

ExperimentResult RunSweepOfMatches(const ExperimentSettings& settings,
                                   const std::string& output) {
  const std::vector<std::string> losses =
      ChosenLosses(settings, MEstimatorNames());
  if (settings.seeds < 1 || settings.seeds > kMaxSeeds) {
    throw InputError("--seeds must be 1 to " + std::to_string(kMaxSeeds));
  }
  PrepareOutput(output);
  const std::vector<SweepCell> cells =
      RunSweep(settings.odometry.estimator, losses, settings.seeds);
  WriteOutput(output, "sweep.csv", SweepCsv(cells));
  return {"# M-estimators on wrong matches\n\n" + SweepVerdict(cells) +
          "\n\nMedian translation errors (mm) and their 95 % bands over " +
          std::to_string(settings.seeds) + " trials of " +
          std::to_string(kMatches) +
          " matches with Kinect noise;\ngraduated losses that start from "
          "identity:\n\n" +
          SweepTable(cells)};
}

}  // namespace rgbd_pose
