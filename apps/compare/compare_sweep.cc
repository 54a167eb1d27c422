#include "apps/compare/compare_sweep.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/initial_guess/consensus.h"
#include "core/util/format.h"
#include "core/util/parallel_for.h"
#include "core/util/quantile.h"
#include "frontend/simulation/synthetic_matches.h"

namespace rgbd_pose {
namespace {

// Typical motion between a reference and a frame tenths of a second later.
constexpr double kMaxAngle = 0.1;        // rad
constexpr double kMaxTranslation = 0.1;  // m, along each axis
constexpr unsigned kFirstSeed = 7000;    // different from the benchmarks' seeds

struct MotionError {
  double rotation_deg = 0.0;
  double translation_mm = 0.0;
};

MotionError ErrorOf(const Rigid3d& estimate, const Rigid3d& truth) {
  const Rigid3d difference = estimate.Inverse() * truth;
  return {difference.Angle() * 180.0 / M_PI,
          difference.translation.norm() * 1e3};
}

Estimator MakeEstimator(EstimatorSettings settings, const SweepMethod& method) {
  settings.loss = method.loss;
  settings.options.schedule =
      method.schedule == "gnc" ? RobustSchedule::kGnc : RobustSchedule::kDirect;
  return MakeEstimator(settings);
}

// The errors of all methods on the matches of one seed.
std::vector<MotionError> RunSeed(int seed, double outlier_share, int matches,
                                 const std::vector<SweepMethod>& methods,
                                 std::vector<Estimator>* estimators) {
  RandomWorld world(kFirstSeed + seed);
  const Rigid3d truth = world.Motion(kMaxAngle, kMaxTranslation);
  const Correspondences found = world.Matches(matches, outlier_share, truth);
  const std::optional<Consensus> consensus = FindByRansac(found);
  const Rigid3d ransac =
      consensus.has_value() ? consensus->cur_from_prev : Rigid3d();
  std::vector<MotionError> errors;
  for (size_t i = 0; i < methods.size(); ++i) {
    const Rigid3d guess = methods[i].ransac ? ransac : Rigid3d();
    errors.push_back(
        ErrorOf((*estimators)[i].Estimate(found, guess).cur_from_prev, truth));
  }
  return errors;
}

}  // namespace

int MedianBandRank(int count) {
  constexpr double kTail = 0.025;  // on each side
  double below = 0.0;  // probability that at most `rank` values are below
  for (int rank = 0; rank < count / 2; ++rank) {
    below += std::exp(std::lgamma(count + 1.0) - std::lgamma(rank + 1.0) -
                      std::lgamma(count - rank + 1.0) - count * std::log(2.0));
    if (below > kTail) return std::max(0, rank - 1);
  }
  return 0;
}

MedianBand FindMedianBand(std::vector<double> values) {
  if (values.empty()) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return {nan, nan, nan, nan};
  }
  std::sort(values.begin(), values.end());
  const int count = static_cast<int>(values.size());
  const int rank = MedianBandRank(count);
  MedianBand band;
  band.median = Median(values);
  band.low = values[rank];
  band.high = values[count - 1 - rank];
  band.p90 = values[std::max(0, (9 * count + 9) / 10 - 1)];
  return band;
}

std::string FormatBand(const MedianBand& band) {
  return Format("%.3g [%.3g, %.3g]", band.median, band.low, band.high);
}

std::vector<SweepMethod> SweepMethods(const std::vector<std::string>& losses) {
  std::vector<SweepMethod> methods;
  for (const std::string& loss : losses) {
    for (const char* schedule : {"gnc", "direct"}) {
      for (const bool ransac : {false, true}) {
        methods.push_back({loss, schedule, ransac});
      }
    }
  }
  return methods;
}

std::vector<SweepCell> RunSweep(const SweepOptions& options) {
  const std::vector<SweepMethod> methods = SweepMethods(options.losses);
  // Each thread needs its own estimators.
  std::vector<std::vector<Estimator>> estimators(options.threads);
  for (std::vector<Estimator>& own : estimators) {
    for (const SweepMethod& method : methods) {
      own.push_back(MakeEstimator(options.estimator, method));
    }
  }
  std::vector<SweepCell> cells(methods.size() * kSweepShares);
  for (int share = 0; share < kSweepShares; ++share) {
    std::vector<std::vector<MotionError>> errors(options.seeds);
    ParallelFor(options.threads, options.threads, [&](int thread) {
      for (int seed = thread; seed < options.seeds; seed += options.threads) {
        errors[seed] = RunSeed(seed, SweepShare(share), options.matches,
                               methods, &estimators[thread]);
      }
    });
    for (size_t i = 0; i < methods.size(); ++i) {
      std::vector<double> rotations, translations;
      for (const std::vector<MotionError>& of_seed : errors) {
        rotations.push_back(of_seed[i].rotation_deg);
        translations.push_back(of_seed[i].translation_mm);
      }
      cells[i * kSweepShares + share] = {methods[i], SweepShare(share),
                                         FindMedianBand(rotations),
                                         FindMedianBand(translations)};
    }
  }
  return cells;
}

std::vector<SweepCell> CellsOf(const std::vector<SweepCell>& cells,
                               const SweepMethod& method) {
  std::vector<SweepCell> chosen;
  for (const SweepCell& cell : cells) {
    if (cell.method.loss == method.loss &&
        cell.method.schedule == method.schedule &&
        cell.method.ransac == method.ransac) {
      chosen.push_back(cell);
    }
  }
  return chosen;
}

std::vector<std::string> LossesOf(const std::vector<SweepCell>& cells) {
  std::vector<std::string> losses;
  for (const SweepCell& cell : cells) {
    if (losses.empty() || losses.back() != cell.method.loss) {
      losses.push_back(cell.method.loss);
    }
  }
  return losses;
}

}  // namespace rgbd_pose
