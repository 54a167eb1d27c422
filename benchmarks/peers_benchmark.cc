// The motion from the same matches, by this project and by other methods: time
// and error. Inputs are prepared before the clock starts.
//
// Names: peers/<method>; an iteration solves every trial once.

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core/utility.hpp>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "benchmarks/pnp_peer.h"
#include "core/estimation/estimator.h"
#include "core/initial_guess/consensus.h"
#include "core/util/quantile.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/motion_error.h"

namespace rgbd_pose {
namespace {

constexpr int kTrials = 100;
constexpr int kMatches = 300;
constexpr double kOutlierShare = 0.2;
// A motion as between a reference and a frame some tenths of a second later.
constexpr double kMaxAngle = 0.1;        // rad
constexpr double kMaxTranslation = 0.1;  // m, along each axis

struct Trial {
  Rigid3d truth;
  Correspondences matches;
  PnpInput pnp;
  Eigen::Matrix3Xd prev, cur;  // points, m

  Trial(const Rigid3d& motion, const Correspondences& all)
      : truth(motion),
        matches(all),
        pnp(all),
        prev(3, all.size()),
        cur(3, all.size()) {
    for (size_t i = 0; i < all.size(); ++i) {
      prev.col(i) = all.Point(all[i].prev);
      cur.col(i) = all.Point(all[i].cur);
    }
  }
};

const std::vector<Trial>& Trials() {
  static const std::vector<Trial> trials = [] {
    std::vector<Trial> made;
    for (int seed = 0; seed < kTrials; ++seed) {
      RandomWorld world(seed);
      const Rigid3d truth = world.Motion(kMaxAngle, kMaxTranslation);
      made.emplace_back(truth, world.Matches(kMatches, kOutlierShare, truth));
    }
    return made;
  }();
  return trials;
}

using Method = std::optional<Rigid3d> (*)(const Trial&);

std::optional<Rigid3d> Estimate(const Trial& trial) {
  static Estimator estimator({}, MakeRobustCosts());
  static MotionEstimate estimate;
  estimator.Estimate({&trial.matches}, Rigid3d(), &estimate);
  if (!estimate.ok()) return std::nullopt;
  return estimate.cur_from_prev;
}

std::optional<Rigid3d> Ransac(const Trial& trial) {
  const std::optional<Consensus> consensus = FindByRansac(trial.matches);
  if (!consensus.has_value()) return std::nullopt;
  return consensus->cur_from_prev;
}

// Textbook RANSAC: samples of three, Euclidean distances, a final fit to all
// inliers, with the same number of samples and confidence as the others.
std::optional<Rigid3d> UmeyamaRansac(const Trial& trial) {
  constexpr int kMaxSamples = 500;
  constexpr double kConfidence = 0.999;
  // From 0.02 to 0.1 m the errors change by at most a fifth.
  constexpr double kMaxDistance = 0.05;
  const int size = static_cast<int>(trial.prev.cols());
  std::mt19937 generator(1);
  std::vector<int> inliers, best;
  double samples = kMaxSamples;
  for (int sample = 0; sample < samples; ++sample) {
    Eigen::Matrix3d prev, cur;
    for (int k = 0; k < 3; ++k) {
      const int i = static_cast<int>(generator() % size);
      prev.col(k) = trial.prev.col(i);
      cur.col(k) = trial.cur.col(i);
    }
    const Eigen::Matrix4d motion = Eigen::umeyama(prev, cur, false);
    const Eigen::Matrix3d R = motion.topLeftCorner<3, 3>();
    const Eigen::Vector3d t = motion.topRightCorner<3, 1>();
    inliers.clear();
    for (int i = 0; i < size; ++i) {
      const Eigen::Vector3d e = R * trial.prev.col(i) + t - trial.cur.col(i);
      if (e.squaredNorm() < kMaxDistance * kMaxDistance) inliers.push_back(i);
    }
    if (inliers.size() <= best.size()) continue;
    best = inliers;
    const double all_right =
        std::pow(static_cast<double>(best.size()) / size, 3);
    samples =
        std::min(samples, std::log(1.0 - kConfidence) / std::log1p(-all_right));
  }
  if (best.size() < 3) return std::nullopt;
  Eigen::Matrix3Xd prev(3, best.size()), cur(3, best.size());
  for (size_t k = 0; k < best.size(); ++k) {
    prev.col(k) = trial.prev.col(best[k]);
    cur.col(k) = trial.cur.col(best[k]);
  }
  const Eigen::Matrix4d motion = Eigen::umeyama(prev, cur, false);
  const Eigen::Matrix3d R = motion.topLeftCorner<3, 3>();
  return Rigid3d(Eigen::Quaterniond(R), motion.topRightCorner<3, 1>());
}

std::optional<Rigid3d> Pnp(const Trial& trial) {
  return SolvePnp(trial.pnp, /*refine=*/false);
}

std::optional<Rigid3d> PnpRefined(const Trial& trial) {
  return SolvePnp(trial.pnp, /*refine=*/true);
}

void Measure(benchmark::State& state, Method method) {
  cv::setNumThreads(1);
  const std::vector<Trial>& trials = Trials();
  for (auto _ : state) {
    for (const Trial& trial : trials) {
      benchmark::DoNotOptimize(method(trial));
    }
  }
  std::vector<double> angles, translations;
  for (const Trial& trial : trials) {
    const std::optional<Rigid3d> found = method(trial);
    if (!found.has_value()) continue;
    const MotionError error = ErrorOf(*found, trial.truth);
    angles.push_back(error.angle * 180.0 / M_PI);
    translations.push_back(error.translation * 1e3);
  }
  state.counters["calls"] = kTrials;  // per iteration
  state.counters["solved"] = static_cast<double>(angles.size());
  state.counters["rotation_deg"] = Median(angles);
  state.counters["translation_mm"] = Median(translations);
}

BENCHMARK_CAPTURE(Measure, estimator, Estimate)->Name("peers/estimator");
BENCHMARK_CAPTURE(Measure, ransac, Ransac)->Name("peers/ransac");
BENCHMARK_CAPTURE(Measure, umeyama, UmeyamaRansac)
    ->Name("peers/umeyama_ransac");
BENCHMARK_CAPTURE(Measure, pnp, Pnp)->Name("peers/pnp_ransac");
BENCHMARK_CAPTURE(Measure, pnp_refined, PnpRefined)
    ->Name("peers/pnp_ransac_refined");

}  // namespace
}  // namespace rgbd_pose
