#include "apps/compare/compare_sweep_report.h"

#include "apps/figures/svg_chart.h"
#include "apps/shell/csv_table.h"
#include "core/util/format.h"
#include "core/util/input_error.h"

namespace rgbd_pose {
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

std::vector<SweepCell> ReadSweepCsv(const std::string& path) {
  const CsvTable table = CsvTable::Read(path);
  const std::vector<std::string> losses = table.Words("loss");
  const std::vector<std::string> schedules = table.Words("schedule");
  const std::vector<std::string> starts = table.Words("start");
  const std::vector<double> shares = table.Numbers("wrong_share");
  std::vector<SweepCell> cells(table.size());
  for (size_t i = 0; i < cells.size(); ++i) {
    cells[i].method = {losses[i], schedules[i], starts[i] == "ransac"};
    cells[i].outlier_share = shares[i];
  }
  const struct {
    const char* column;
    MedianBand SweepCell::*band;
    double MedianBand::*value;
  } kColumns[] = {
      {"rotation_median_deg", &SweepCell::rotation_deg, &MedianBand::median},
      {"rotation_low_deg", &SweepCell::rotation_deg, &MedianBand::low},
      {"rotation_high_deg", &SweepCell::rotation_deg, &MedianBand::high},
      {"rotation_p90_deg", &SweepCell::rotation_deg, &MedianBand::p90},
      {"translation_median_mm", &SweepCell::translation_mm,
       &MedianBand::median},
      {"translation_low_mm", &SweepCell::translation_mm, &MedianBand::low},
      {"translation_high_mm", &SweepCell::translation_mm, &MedianBand::high},
      {"translation_p90_mm", &SweepCell::translation_mm, &MedianBand::p90}};
  for (const auto& c : kColumns) {
    const std::vector<double> numbers = table.Numbers(c.column);
    for (size_t i = 0; i < cells.size(); ++i) {
      cells[i].*c.band.*c.value = numbers[i];
    }
  }
  for (const std::string& loss : LossesOf(cells)) {
    for (const char* schedule : {"gnc", "direct"}) {
      for (const bool ransac : {false, true}) {
        if (CellsOf(cells, {loss, schedule, ransac}).size() == kSweepShares) {
          continue;
        }
        throw InputError(path + ": not all shares of " + loss + ", " +
                         schedule + ", " + (ransac ? "RANSAC" : "no guess") +
                         "; repeat the sweep");
      }
    }
  }
  if (cells.empty()) throw InputError(path + ": no rows; repeat the sweep");
  return cells;
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
  chart.title =
      rotation ? "Median rotation errors with their 95 % bands, from no motion"
               : "Median translation errors with their 95 % bands, from no "
                 "motion";
  chart.panel_width_px = 330;
  chart.panel_height_px = 420;
  chart.same_ranges = true;
  chart.label_lines = true;
  for (const char* schedule : {"gnc", "direct"}) {
    ChartPanel panel;
    panel.title = schedule == std::string("gnc")
                      ? "Graduated from wide to narrow (gnc)"
                      : "At their widths at once (direct)";
    panel.x_label = "wrong matches (%)";
    panel.y_label = rotation ? "error (deg)" : "error (mm)";
    panel.log_y = true;
    int style = 0;
    for (const std::string& loss : LossesOf(cells)) {
      ChartSeries series;
      series.label = loss;
      series.style = StyleOf(style++);
      for (const SweepCell& cell : CellsOf(cells, {loss, schedule, false})) {
        const MedianBand& band =
            rotation ? cell.rotation_deg : cell.translation_mm;
        series.points.push_back(
            {cell.outlier_share * 100.0, band.median, band.low, band.high});
      }
      panel.series.push_back(series);
    }
    chart.panels.push_back(panel);
  }
  return FormatSvg(chart);
}

}  // namespace rgbd_pose
