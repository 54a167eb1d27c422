#include "robust/barron_alpha.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "robust/barron_loss.h"

namespace rgbd_pose {
namespace {

constexpr double kMaxAlpha = 2.0;
constexpr double kAlphaStep = 0.25;
constexpr int kAlphaSteps = 24;     // down to -4
constexpr double kFarthest = 10.0;  // widths

// -ln of the density at a norm of x widths, but for its normalisation.
double NegativeLog(const BarronLoss& loss, double x) {
  double rho[3];
  loss.Evaluate(x * x, rho);
  return 0.5 * rho[0];
}

// The integral of the density over norms; over directions it is the same for
// all shapes. By the midpoint rule: the integrand is smooth.
double Normalisation(const BarronLoss& loss, int dimension) {
  constexpr int kSteps = 500;
  constexpr double kStep = kFarthest / kSteps;
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = (i + 0.5) * kStep;
    sum += std::pow(x, dimension - 1) * std::exp(-NegativeLog(loss, x));
  }
  return sum * kStep;
}

}  // namespace

double MostLikelyBarronAlpha(const std::vector<double>& norms, int dimension,
                             double width) {
  double best_alpha = kMaxAlpha;
  double best = std::numeric_limits<double>::infinity();
  for (int step = 0; step <= kAlphaSteps; ++step) {
    const double alpha = kMaxAlpha - step * kAlphaStep;
    const BarronLoss loss(1.0, alpha);
    double value = norms.size() * std::log(Normalisation(loss, dimension));
    for (const double norm : norms) {
      value += NegativeLog(loss, std::min(norm / width, kFarthest));
    }
    if (value < best) {
      best = value;
      best_alpha = alpha;
    }
  }
  return best_alpha;
}

}  // namespace rgbd_pose
