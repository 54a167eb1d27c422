#include <algorithm>
#include <cmath>
#include <vector>

#include "apps/figures/svg_chart.h"
#include "apps/report/report_page.h"
#include "core/util/format.h"
#include "core/util/quantile.h"
#include "frontend/calibration/calibration_result.h"

namespace rgbd_pose {
namespace {

// Number of image columns over which residuals are averaged.
constexpr int kCells = 16;

constexpr double kWidth = 440.0;

// Wrong matches would dominate the pictures.
constexpr double kMostPx = 20.0;

using Vectors = std::vector<Eigen::Vector2d>;

// Mean residuals per image cell as arrows, enlarged by `zoom`.
std::string Arrows(const CalibrationResult& result, bool after, double zoom) {
  const Camera& camera = result.camera.camera;
  const double cell = static_cast<double>(camera.width) / kCells;
  const int rows = static_cast<int>(std::ceil(camera.height / cell));
  std::vector<Eigen::Vector2d> sums(kCells * rows, Eigen::Vector2d::Zero());
  std::vector<int> counts(kCells * rows, 0);
  for (const HeldOutResidual& residual : result.residuals) {
    const int column = static_cast<int>(residual.u / cell);
    const int row = static_cast<int>(residual.v / cell);
    if (column < 0 || row < 0 || column >= kCells || row >= rows) continue;
    const Eigen::Vector2d& r = after ? residual.after : residual.before;
    if (!(r.norm() < kMostPx)) continue;
    sums[row * kCells + column] += r;
    ++counts[row * kCells + column];
  }
  const double scale = kWidth / camera.width;
  std::string text = Format("<figure><svg width=\"%.0f\" height=\"%.0f\">",
                            kWidth, camera.height * scale);
  constexpr int kFew = 3;
  for (int i = 0; i < kCells * rows; ++i) {
    if (counts[i] < kFew) continue;
    const Eigen::Vector2d mean = sums[i] / counts[i] * zoom;
    const int column = i % kCells, row = i / kCells;
    const double u = (column + 0.5) * cell * scale;
    const double v = (row + 0.5) * cell * scale;
    text += Format(
        "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" "
        "stroke=\"#d62728\" stroke-width=\"1.5\"/><circle cx=\"%.1f\" "
        "cy=\"%.1f\" r=\"2\" fill=\"#555\"/>",
        u, v, u + mean.x() * scale, v + mean.y() * scale, u, v);
  }
  return text + Format(
                    "</svg><figcaption>Mean residuals %s, enlarged %.0f times"
                    "</figcaption></figure>\n",
                    after ? "with the camera found" : "with the first camera",
                    zoom);
}

// The residuals of one camera, in bins of equal size by `key`. A point is what
// `value` makes of the residuals in a bin and of their motion.
template <typename Key, typename Value>
ChartSeries Binned(const CalibrationResult& result, bool after, Key key,
                   Value value) {
  std::vector<const HeldOutResidual*> sorted;
  for (const HeldOutResidual& residual : result.residuals) {
    const double px = (after ? residual.after : residual.before).norm();
    // A landmark at infinity has no motion.
    const bool is_known = residual.flow.allFinite() && px < kMostPx;
    if (is_known) sorted.push_back(&residual);
  }
  std::sort(sorted.begin(), sorted.end(),
            [&](const auto* a, const auto* b) { return key(*a) < key(*b); });
  ChartSeries line;
  line.label = after ? "with the camera found" : "with the first camera";
  line.style = StyleOf(after ? 1 : 0);
  constexpr size_t kBins = 12, kFew = 20;
  const size_t bins = std::min(kBins, sorted.size() / kFew);
  for (size_t bin = 0; bin < bins; ++bin) {
    double keys = 0.0;
    Vectors residuals, flows;
    const size_t begin = bin * sorted.size() / bins;
    const size_t end = (bin + 1) * sorted.size() / bins;
    for (size_t i = begin; i < end; ++i) {
      keys += key(*sorted[i]);
      residuals.push_back(after ? sorted[i]->after : sorted[i]->before);
      flows.push_back(sorted[i]->flow);
    }
    line.points.push_back({keys / (end - begin), value(residuals, flows)});
  }
  return line;
}

// How much later (ms) than expected these pixels were exposed: seen is
// predicted + flow t, so the residual is -flow t; t by least squares.
double LateMs(const Vectors& residuals, const Vectors& flows) {
  double along = 0.0, square = 0.0;
  for (size_t i = 0; i < residuals.size(); ++i) {
    along -= residuals[i].dot(flows[i]);
    square += flows[i].squaredNorm();
  }
  return square > 0.0 ? 1e3 * along / square : std::nan("");
}

double MedianPx(const Vectors& residuals, const Vectors& /*flows*/) {
  std::vector<double> lengths;
  for (const Eigen::Vector2d& r : residuals) lengths.push_back(r.norm());
  return Median(lengths);
}

std::string Charts(const CalibrationResult& result) {
  const auto row = [](const HeldOutResidual& r) { return r.v; };
  const auto speed = [](const HeldOutResidual& r) { return r.flow.norm(); };
  Chart chart;
  chart.panels = {{"Exposed later than expected", "row (px)", "ms"},
                  {"Residuals over speed", "motion in the image (px/s)",
                   "median residual (px)"}};
  for (const bool after : {false, true}) {
    chart.panels[0].series.push_back(Binned(result, after, row, LateMs));
    chart.panels[1].series.push_back(Binned(result, after, speed, MedianPx));
  }
  chart.panel_height_px = 260;
  return chart.panels[0].series[0].points.empty()
             ? ""
             : "<figure>" + FormatSvg(chart) +
                   "<figcaption>Left: a line that rises or falls is a wrong "
                   "readout, one above or below 0 a wrong delay. Right: a line "
                   "that rises is an error of time or blur; a level one is the "
                   "noise of features.</figcaption></figure>\n";
}

}  // namespace

std::string ResidualPictures(const CalibrationResult& result) {
  const double spread = std::max(0.5 * result.pixel_before, 1e-3);
  const double zoom = std::clamp(std::round(10.0 / spread), 1.0, 200.0);
  return Arrows(result, false, zoom) + Arrows(result, true, zoom) +
         Charts(result);
}

}  // namespace rgbd_pose
