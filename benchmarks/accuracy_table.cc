// Compares costs and losses on the same noise and the same wrong matches:
// medians of rotation and translation errors over many seeds, as Markdown, next
// to closed-form RANSAC and OpenCV's PnP on the same matches.

#include <gflags/gflags.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/pnp_peer.h"
#include "core/estimation/estimator.h"
#include "core/initial_guess/consensus.h"
#include "core/util/format.h"
#include "core/util/quantile.h"
#include "costs/cost_factory.h"
#include "frontend/simulation/synthetic_matches.h"
#include "tests/support/motion_error.h"

DEFINE_int32(seeds, 1000, "trials a cell");
DEFINE_int32(matches, 300, "matches a trial");

namespace rgbd_pose {
namespace {

constexpr double kOutlierShares[] = {0.0, 0.4, 0.7};
// A motion as between a reference and a frame some tenths of a second later.
constexpr double kMaxAngle = 0.1;        // rad
constexpr double kMaxTranslation = 0.1;  // m, along each axis
// Share of depths that are missing, for costs that allow it.
constexpr double kMissingDepthShare = 0.2;

struct Trial {
  Rigid3d truth;
  Correspondences matches;
};

Trial MakeTrial(int seed, double outliers, double missing_depth) {
  RandomWorld world(5000 + seed);
  Trial trial;
  trial.truth = world.Motion(kMaxAngle, kMaxTranslation);
  trial.matches = world.Matches(FLAGS_matches, outliers, trial.truth,
                                /*noise=*/true, missing_depth);
  return trial;
}

// A method that computes a motion from matches.
struct Method {
  std::string name;
  double missing_depth = 0.0;
  std::function<std::optional<Rigid3d>(const Trial&)> find;
};

std::vector<Method> OurMethods() {
  std::vector<std::pair<std::string, double>> costs;
  for (const std::string& name : CostNames()) {
    // Neither alone determines a motion: one lacks scale, the other matches.
    if (name == "epipolar" || name == "motion_prior") continue;
    costs.emplace_back(name, 0.0);
  }
  costs.emplace_back("reprojection_depth", kMissingDepthShare);
  costs.emplace_back("reprojection_depth+epipolar", kMissingDepthShare);
  costs.emplace_back("bidirectional_image", kMissingDepthShare);
  std::vector<Method> methods;
  for (const auto& [cost, missing] : costs) {
    auto estimator =
        std::make_shared<Estimator>(EstimatorOptions(), MakeRobustCosts(cost));
    methods.push_back({missing > 0.0 ? cost + " *" : cost, missing,
                       [estimator](const Trial& trial) {
                         return std::optional<Rigid3d>(
                             estimator->Estimate(trial.matches).cur_from_prev);
                       }});
  }
  return methods;
}

std::optional<Rigid3d> Ransac(const Trial& trial) {
  const std::optional<Consensus> consensus = FindByRansac(trial.matches);
  if (!consensus.has_value()) return std::nullopt;
  return consensus->cur_from_prev;
}

std::optional<Rigid3d> PnpRansac(const Trial& trial) {
  return SolvePnp(PnpInput(trial.matches), /*refine=*/true);
}

struct Cell {
  double median_deg = 0.0;
  double median_mm = 0.0;
  double mean_square_deg2 = 0.0;
  double mean_square_mm2 = 0.0;
  int failures = 0;
};

constexpr double kDegrees = 180.0 / M_PI;

Cell Measure(const Method& method, double outliers) {
  Cell cell;
  std::vector<double> angles, translations;
  for (int seed = 0; seed < FLAGS_seeds; ++seed) {
    const Trial trial = MakeTrial(seed, outliers, method.missing_depth);
    const std::optional<Rigid3d> found = method.find(trial);
    if (!found.has_value()) {
      ++cell.failures;
      continue;
    }
    const MotionError error = ErrorOf(*found, trial.truth);
    angles.push_back(error.angle * kDegrees);
    translations.push_back(error.translation * 1e3);
    cell.mean_square_deg2 += angles.back() * angles.back();
    cell.mean_square_mm2 += translations.back() * translations.back();
  }
  const double count = std::max<size_t>(1, angles.size());
  cell.mean_square_deg2 /= count;
  cell.mean_square_mm2 /= count;
  cell.median_deg = Median(angles);
  cell.median_mm = Median(translations);
  return cell;
}

// The Cramer-Rao bound without outliers, as root mean squares. For normal noise
// in (u, v, depth) of both frames, the Fisher information of the motion is the
// Hessian of the fully whitened 3D cost at the truth, from noiseless matches.
struct Bound {
  double deg = 0.0;
  double mm = 0.0;
};

Bound FindBound() {
  std::unique_ptr<MotionCost> cost = MakeCost("mahalanobis_point");
  double deg2 = 0.0, mm2 = 0.0;
  for (int seed = 0; seed < FLAGS_seeds; ++seed) {
    RandomWorld world(5000 + seed);
    const Rigid3d truth = world.Motion(kMaxAngle, kMaxTranslation);
    const Correspondences matches =
        world.Matches(FLAGS_matches, 0.0, truth, /*noise=*/false);
    cost->Bind({&matches});
    cost->Associate(truth);
    const MotionVector zero = MotionVector::Zero();
    NormalEquations sum;
    cost->Linearise(LinearizationPoint(truth).DerivativesAt(zero.data()),
                    nullptr, &sum);
    const MotionMatrix bound = sum.hessian.inverse();
    deg2 += bound.topLeftCorner<3, 3>().trace() * kDegrees * kDegrees;
    mm2 += bound.bottomRightCorner<3, 3>().trace() * 1e6;
  }
  return {std::sqrt(deg2 / FLAGS_seeds), std::sqrt(mm2 / FLAGS_seeds)};
}

void PrintRow(const Method& method, const Bound& bound) {
  std::printf("| %s |", method.name.c_str());
  std::string times_bound;
  for (const double outliers : kOutlierShares) {
    const Cell cell = Measure(method, outliers);
    std::printf(" %.4f, %.2f", cell.median_deg, cell.median_mm);
    if (cell.failures > 0) std::printf(" (%d failed)", cell.failures);
    std::printf(" |");
    if (outliers == 0.0 && method.missing_depth == 0.0) {
      times_bound =
          Format("%.2f, %.2f", std::sqrt(cell.mean_square_deg2) / bound.deg,
                 std::sqrt(cell.mean_square_mm2) / bound.mm);
    }
  }
  std::printf(" %s |\n", times_bound.c_str());
  std::fflush(stdout);
}

void Main() {
  const Bound bound = FindBound();
  std::printf(
      "Median errors, rotation (deg) and translation (mm), over %d seeds; %d "
      "matches at 1-4 m\nwith Kinect noise (0.5 px in each frame, 1.425e-3 "
      "z^2 m); motions up to %.1f deg and %.0f mm\nalong each axis; the guess "
      "is no motion. *: without the depth of %.0f %% of the observations\nof "
      "each frame. Last column: root mean square errors over the Cramer-Rao "
      "bound\n(%.4f deg, %.3f mm).\n\n",
      FLAGS_seeds, FLAGS_matches, kMaxAngle * kDegrees, kMaxTranslation * 1e3,
      kMissingDepthShare * 100, bound.deg, bound.mm);
  std::printf(
      "| cost | 0 %% wrong | 40 %% | 70 %% | 0 %%, over bound |\n"
      "|---|---|---|---|---|\n");
  std::vector<Method> methods = OurMethods();
  methods.push_back({"RANSAC (ours)", 0.0, Ransac});
  methods.push_back({"cv::solvePnPRansac, refined", 0.0, PnpRansac});
  for (const Method& method : methods) PrintRow(method, bound);
}

}  // namespace
}  // namespace rgbd_pose

int main(int argc, char** argv) {
  gflags::ParseCommandLineFlags(&argc, &argv, true);
  rgbd_pose::Main();
  return 0;
}
