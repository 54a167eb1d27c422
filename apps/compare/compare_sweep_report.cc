#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/compare/compare_sweep.h"
#include "apps/shell/csv_table.h"
#include "core/util/format.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

// The figures of sweep.csv.
constexpr struct {
  const char* name;
  MedianBand SweepCell::*band;
  double MedianBand::*value;
} kCsvColumns[] = {
    {"rotation_median_deg", &SweepCell::rotation_deg, &MedianBand::median},
    {"rotation_low_deg", &SweepCell::rotation_deg, &MedianBand::low},
    {"rotation_high_deg", &SweepCell::rotation_deg, &MedianBand::high},
    {"rotation_p90_deg", &SweepCell::rotation_deg, &MedianBand::p90},
    {"translation_median_mm", &SweepCell::translation_mm, &MedianBand::median},
    {"translation_low_mm", &SweepCell::translation_mm, &MedianBand::low},
    {"translation_high_mm", &SweepCell::translation_mm, &MedianBand::high},
    {"translation_p90_mm", &SweepCell::translation_mm, &MedianBand::p90}};

// "median [low, high]", three digits each.
std::string FormatBand(const MedianBand& band) {
  return Format("%.3g [%.3g, %.3g]", band.median, band.low, band.high);
}

bool Meet(const MedianBand& a, const MedianBand& b) {
  return a.low <= b.high && b.low <= a.high;
}

// The geometric mean of the median translation errors over all shares. Each
// share has the same weight, whatever the size of its errors.
double MeanError(const std::vector<SweepCell>& of_method) {
  double sum = 0.0;
  for (const SweepCell& cell : of_method) {
    sum += std::log(cell.translation_mm.median);
  }
  return std::exp(sum / of_method.size());
}

// The losses for which a start from RANSAC changes the median beyond the bands
// in one direction, each with the shares and the amount.
std::string ChangedByRansac(const std::vector<SweepCell>& cells,
                            const std::string& schedule, bool lowered) {
  std::vector<std::string> changed;
  for (const std::string& loss : LossesOf(cells)) {
    const std::vector<SweepCell> alone =
        CellsOf(cells, {loss, schedule, false});
    const std::vector<SweepCell> from_ransac =
        CellsOf(cells, {loss, schedule, true});
    std::vector<std::string> shares;
    std::string last;  // the figures of the largest share
    for (int i = 0; i < kSweepShares; ++i) {
      const MedianBand& before = alone[i].translation_mm;
      const MedianBand& after = from_ransac[i].translation_mm;
      if (Meet(before, after) || (after.median < before.median) != lowered) {
        continue;
      }
      shares.push_back(Format("%.0f", SweepShare(i) * 100.0));
      last = Format("%.3g mm instead of %.3g mm at %.0f %%", after.median,
                    before.median, SweepShare(i) * 100.0);
    }
    if (shares.empty()) continue;
    changed.push_back(loss +
                      (shares.size() == kSweepShares ? " (at every share; "
                       : shares.size() == 1
                           ? " ("
                           : " (at " + Join(shares) + " % wrong matches; ") +
                      last + ")");
  }
  return Join(changed);
}

// Describes the effect of a start from RANSAC under a schedule.
std::string RansacVerdict(const std::vector<SweepCell>& cells,
                          const std::string& schedule) {
  std::vector<std::string> effects;
  for (const bool lowered : {true, false}) {
    const std::string losses = ChangedByRansac(cells, schedule, lowered);
    if (losses.empty()) continue;
    effects.push_back(std::string(lowered ? "lowers" : "raises") +
                      " the median beyond the bands for " + losses);
  }
  return " Under the " + schedule + " schedule a start from RANSAC " +
         (effects.empty() ? "changes no median beyond the bands, at any share"
                          : Join(effects, " and ")) +
         ".";
}

}  // namespace

std::string SweepVerdict(const std::vector<SweepCell>& cells) {
  std::vector<std::pair<double, std::string>> ranking;
  for (const std::string& loss : LossesOf(cells)) {
    ranking.emplace_back(MeanError(CellsOf(cells, {loss, "gnc", false})), loss);
  }
  std::sort(ranking.begin(), ranking.end());
  const std::string& best = ranking.front().second;
  const std::vector<SweepCell> own = CellsOf(cells, {best, "gnc", false});
  std::vector<std::string> level;  // bands always overlap the best one's
  for (const auto& [error, loss] : ranking) {
    const std::vector<SweepCell> other = CellsOf(cells, {loss, "gnc", false});
    bool meets = loss != best;
    for (int i = 0; i < kSweepShares; ++i) {
      meets = meets && Meet(other[i].translation_mm, own[i].translation_mm);
    }
    if (meets) level.push_back(loss);
  }
  const SweepCell& clean = own.front();
  const SweepCell& worst = own.back();
  std::string text = Format(
      "Of the graduated losses that start from identity, %s has the smallest "
      "median translation errors (geometric mean over all shares of wrong "
      "matches %.3g mm): %s mm without wrong matches and %s mm with %.0f %% of "
      "them, where nine of ten trials stay below %.3g mm.",
      best.c_str(), ranking.front().first,
      FormatBand(clean.translation_mm).c_str(),
      FormatBand(worst.translation_mm).c_str(), worst.outlier_share * 100.0,
      worst.translation_mm.p90);
  if (!level.empty()) {
    text +=
        " Equally good at every share (the 95 % bands of the medians "
        "overlap): " +
        Join(level) + ".";
  } else if (ranking.size() > 1) {
    text += " No other loss is equally good at every share.";
  }
  for (const char* rival : {"none", "huber"}) {
    const std::vector<SweepCell> other = CellsOf(cells, {rival, "gnc", false});
    if (other.empty() || rival == best) continue;
    const auto ratio = [&](int share) {
      return other[share].translation_mm.median /
             own[share].translation_mm.median;
    };
    text += Format(
        " The error of %s is %.3g times as large at 0 %%, %.3g times at 30 %% "
        "and %.3g times at 60 %%.",
        rival, ratio(0), ratio(3), ratio(6));
  }
  for (const char* schedule : {"gnc", "direct"}) {
    text += RansacVerdict(cells, schedule);
  }
  return text;
}

std::string SweepCsv(const std::vector<SweepCell>& cells) {
  std::string text = "loss,schedule,start,wrong_share";
  for (const auto& column : kCsvColumns) text += std::string(",") + column.name;
  text += "\n";
  for (const SweepCell& cell : cells) {
    text += Format("%s,%s,%s,%.1f", cell.method.loss.c_str(),
                   cell.method.schedule.c_str(),
                   cell.method.ransac ? "ransac" : "none", cell.outlier_share);
    for (const auto& column : kCsvColumns) {
      text += Format(",%.6g", cell.*column.band.*column.value);
    }
    text += "\n";
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
  for (const auto& column : kCsvColumns) {
    const std::vector<double> numbers = table.Numbers(column.name);
    for (size_t i = 0; i < cells.size(); ++i) {
      cells[i].*column.band.*column.value = numbers[i];
    }
  }
  for (const SweepMethod& method : SweepMethods(LossesOf(cells))) {
    if (CellsOf(cells, method).size() == kSweepShares) continue;
    throw InputError(path + ": missing shares of " + method.loss + ", " +
                     method.schedule + ", " +
                     (method.ransac ? "from RANSAC" : "from identity") +
                     "; repeat the sweep");
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

}  // namespace rgbd_pose
