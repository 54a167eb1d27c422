#include "apps/compare_sweep_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "apps/svg_chart.h"
#include "core/text_file.h"

namespace rgbd_pose {
namespace {

template <typename... Values>
std::string Format(const char* format, Values... values) {
  char text[1024];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

// The cells of one method, by share; nothing if it did not run.
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

std::string FormatBand(const MedianBand& band) {
  return Format("%.3g [%.3g, %.3g]", band.median, band.low, band.high);
}

// The geometric mean over all shares of the median translation error: every
// share counts the same, whatever its size.
double MeanError(const std::vector<SweepCell>& of_method) {
  double sum = 0.0;
  for (const SweepCell& cell : of_method) {
    sum += std::log(cell.translation_mm.median);
  }
  return std::exp(sum / of_method.size());
}

// For which losses a start from RANSAC is worth it under a schedule.
std::string RansacVerdict(const std::vector<SweepCell>& cells,
                          const std::string& schedule) {
  std::vector<std::string> helped;
  for (const std::string& loss : LossesOf(cells)) {
    const std::vector<SweepCell> alone =
        CellsOf(cells, {loss, schedule, false});
    const std::vector<SweepCell> from_ransac =
        CellsOf(cells, {loss, schedule, true});
    for (int i = 0; i < kSweepShares; ++i) {
      const MedianBand& before = alone[i].translation_mm;
      const MedianBand& after = from_ransac[i].translation_mm;
      if (after.high >= before.low) continue;
      helped.push_back(Format(
          "%s (from %.0f %% wrong matches on: %.3g mm "
          "instead of %.3g mm)",
          loss.c_str(), SweepShare(i) * 100.0, after.median, before.median));
      break;
    }
  }
  return " Under the " + schedule +
         " schedule a start from RANSAC lowers the " +
         "median beyond the bands for " +
         (helped.empty() ? "no loss at any share" : Join(helped)) + ".";
}

}  // namespace

std::string SweepCsv(const std::vector<SweepCell>& cells) {
  std::string text =
      "loss,schedule,start,wrong_share,rotation_median_deg,rotation_low_deg,"
      "rotation_high_deg,rotation_p90_deg,translation_median_mm,"
      "translation_low_mm,translation_high_mm,translation_p90_mm\n";
  for (const SweepCell& cell : cells) {
    const MedianBand& r = cell.rotation_deg;
    const MedianBand& t = cell.translation_mm;
    text +=
        Format("%s,%s,%s,%.1f,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g\n",
               cell.method.loss.c_str(), cell.method.schedule.c_str(),
               cell.method.ransac ? "ransac" : "none", cell.outlier_share,
               r.median, r.low, r.high, r.p90, t.median, t.low, t.high, t.p90);
  }
  return text;
}

std::string SweepTable(const std::vector<SweepCell>& cells) {
  std::string text = "| loss |";
  std::string rule = "|---|";
  for (int i = 0; i < kSweepShares; ++i) {
    text += Format(" %.0f %% wrong |", SweepShare(i) * 100.0);
    rule += "---:|";
  }
  text += "\n" + rule + "\n";
  for (const std::string& loss : LossesOf(cells)) {
    text += "| " + loss + " |";
    for (const SweepCell& cell : CellsOf(cells, {loss, "gnc", false})) {
      text += " " + FormatBand(cell.translation_mm) + " |";
    }
    text += "\n";
  }
  return text;
}

std::string SweepFigure(const std::vector<SweepCell>& cells, bool rotation) {
  Chart chart;
  chart.title = rotation ? "Median rotation error with its 95 % band"
                         : "Median translation error with its 95 % band";
  chart.columns = 4;
  chart.panel_width_px = 190;
  chart.panel_height_px = 180;
  chart.log_y = true;
  for (const std::string& loss : LossesOf(cells)) {
    ChartPanel panel;
    panel.title = loss;
    panel.x_label = "wrong matches (%)";
    panel.y_label = rotation ? "error (deg)" : "error (mm)";
    int colour = 0;
    for (const char* schedule : {"direct", "gnc"}) {
      for (const bool ransac : {false, true}) {
        ChartSeries series;
        series.label =
            std::string(schedule) + (ransac ? ", from RANSAC" : ", no guess");
        series.colour = SeriesColour(colour++);
        series.is_dashed = ransac;
        for (const SweepCell& cell : CellsOf(cells, {loss, schedule, ransac})) {
          const MedianBand& band =
              rotation ? cell.rotation_deg : cell.translation_mm;
          series.points.push_back(
              {cell.outlier_share * 100.0, band.median, band.low, band.high});
        }
        panel.series.push_back(series);
      }
    }
    chart.panels.push_back(panel);
  }
  return FormatSvg(chart);
}

std::string SweepVerdict(const std::vector<SweepCell>& cells) {
  std::vector<std::pair<double, std::string>> ranking;
  for (const std::string& loss : LossesOf(cells)) {
    ranking.emplace_back(MeanError(CellsOf(cells, {loss, "gnc", false})), loss);
  }
  std::sort(ranking.begin(), ranking.end());
  const std::string& best = ranking.front().second;
  const std::vector<SweepCell> own = CellsOf(cells, {best, "gnc", false});
  std::vector<std::string> level;  // bands meet the best one's at every share
  for (const auto& [error, loss] : ranking) {
    const std::vector<SweepCell> other = CellsOf(cells, {loss, "gnc", false});
    bool meets = loss != best;
    for (int i = 0; i < kSweepShares; ++i) {
      meets =
          meets && other[i].translation_mm.low <= own[i].translation_mm.high;
    }
    if (meets) level.push_back(loss);
  }
  const SweepCell& clean = own.front();
  const SweepCell& worst = own.back();
  std::string text = Format(
      "Of the graduated losses that start from no motion, %s has the smallest "
      "median translation errors (geometric mean over all shares of wrong "
      "matches %.3g mm): %s mm without wrong matches and %s mm with %.0f %% of "
      "them, where nine of ten trials stay below %.3g mm.",
      best.c_str(), ranking.front().first,
      FormatBand(clean.translation_mm).c_str(),
      FormatBand(worst.translation_mm).c_str(), worst.outlier_share * 100.0,
      worst.translation_mm.p90);
  text += level.empty()
              ? " No other loss is level with it at every share."
              : " Level with it at every share (the 95 % bands of the medians "
                "meet): " +
                    Join(level) + ".";
  for (const char* rival : {"none", "huber"}) {
    const std::vector<SweepCell> other = CellsOf(cells, {rival, "gnc", false});
    if (other.empty() || rival == best) continue;
    text += Format(
        " Against %s its error is smaller by a factor of %.3g at "
        "0 %%, %.3g at 30 %% and %.3g at 60 %%.",
        rival, other[0].translation_mm.median / own[0].translation_mm.median,
        other[3].translation_mm.median / own[3].translation_mm.median,
        other[6].translation_mm.median / own[6].translation_mm.median);
  }
  for (const char* schedule : {"gnc", "direct"}) {
    text += RansacVerdict(cells, schedule);
  }
  return text;
}

}  // namespace rgbd_pose
