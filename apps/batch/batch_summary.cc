#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/batch/batch_runs.h"
#include "core/util/format.h"
#include "core/util/named_values.h"
#include "core/util/quantile.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

// Columns of the summary and their locations in metrics.json of a run.
constexpr Named<const char*> kFigures[] = {
    {"frames", "/run/frames"},
    {"ok", "/run/ok"},
    {"degraded", "/run/degraded"},
    {"lost", "/run/lost"},
    {"tracked_share", "/run/tracked_share"},
    {"ate_rmse_m", "/evaluation/ate/position_m/rmse"},
    {"rpe_seconds_translation_m", "/evaluation/rpe_seconds/translation_m/rmse"},
    {"rpe_seconds_rotation_deg", "/evaluation/rpe_seconds/rotation_deg/rmse"},
    {"final_translation_m", "/evaluation/final_pose/translation_m"},
    {"final_rotation_deg", "/evaluation/final_pose/rotation_deg"},
    // The following values differ between repeated runs.
    {"track_ms_median", "/run/track_ms_median"},
    {"wall_seconds", "/run/wall_seconds"},
};

// A failed run may have no metrics.
json ReadMetrics(const std::string& folder) {
  const std::filesystem::path path =
      std::filesystem::path(folder) / "metrics.json";
  if (!IsFile(path)) return nullptr;
  return json::parse(ReadTextFile(path.string()), nullptr, false);
}

ordered_json FindFigure(const json& metrics, const char* pointer) {
  const json::json_pointer place(pointer);
  if (!metrics.is_object() || !metrics.contains(place)) return nullptr;
  const json& figure = metrics.at(place);
  return figure.is_number() ? ordered_json(figure) : nullptr;
}

// Names of runs contain neither commas nor quotes.
std::string FormatCell(const ordered_json& value) {
  if (value.is_null()) return "";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string FormatScaled(const ordered_json& value, double factor, int digits) {
  if (!value.is_number()) return "-";
  return Format("%.*f", digits, factor * value.get<double>());
}

bool IsVaried(const BatchSummary& summary, const char* column) {
  return std::any_of(summary.begin(), summary.end(), [&](const auto& row) {
    return row[column] != summary[0][column];
  });
}

using Cells = std::vector<std::string>;

// Formats rows under a header; right-aligns columns from `first_figure` on.
std::string FormatColumns(const std::vector<Cells>& rows, size_t first_figure) {
  std::vector<size_t> widths(rows[0].size());
  for (const auto& row : rows) {
    for (size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], row[i].size());
    }
  }
  std::string text;
  for (const auto& row : rows) {
    for (size_t i = 0; i < row.size(); ++i) {
      const std::string space(widths[i] - row[i].size(), ' ');
      text += i < first_figure ? row[i] + space : space + row[i];
      text += i + 1 < row.size() ? "  " : "\n";
    }
  }
  return text;
}

Cells NamedCells(const ordered_json& row, const Cells& names) {
  Cells cells;
  for (const std::string& name : names) cells.push_back(FormatCell(row[name]));
  return cells;
}

std::string TableOfRuns(const BatchSummary& summary, Cells names) {
  names.emplace_back("repeat");
  names.emplace_back("status");
  std::vector<Cells> rows = {names};
  rows[0].insert(rows[0].end(),
                 {"tracked %", "ATE mm", "RPE over 1 s mm", "deg", "ms/frame"});
  for (const ordered_json& row : summary) {
    rows.push_back(NamedCells(row, names));
    rows.back().insert(
        rows.back().end(),
        {FormatScaled(row["tracked_share"], 100.0, 1),
         FormatScaled(row["ate_rmse_m"], 1000.0, 2),
         FormatScaled(row["rpe_seconds_translation_m"], 1000.0, 2),
         FormatScaled(row["rpe_seconds_rotation_deg"], 1.0, 3),
         FormatScaled(row["track_ms_median"], 1.0, 2)});
  }
  return FormatColumns(rows, names.size());
}

// One row for all parts of a sequence with otherwise equal settings, because
// the result of a single part may be chance.
std::string TableOfParts(const BatchSummary& summary, const Cells& names) {
  std::vector<Cells> rows = {names};
  rows[0].insert(rows[0].end(), {"runs", "tracked % min", "ATE mm", "min",
                                 "max", "RPE over 1 s mm", "min", "max"});
  std::vector<Cells> settings;  // in order of appearance
  std::map<Cells, std::vector<const ordered_json*>> runs;
  for (const ordered_json& row : summary) {
    const Cells own = NamedCells(row, names);
    if (runs.count(own) == 0) settings.push_back(own);
    runs[own].push_back(&row);
  }
  for (const Cells& own : settings) {
    Cells cells = own;
    cells.push_back(std::to_string(runs[own].size()));
    double least_tracked = 1.0;
    for (const ordered_json* row : runs[own]) {
      const ordered_json& share = (*row)["tracked_share"];
      least_tracked = std::min(least_tracked,
                               share.is_number() ? share.get<double>() : 0.0);
    }
    cells.push_back(Format("%.1f", 100.0 * least_tracked));
    for (const char* figure : {"ate_rmse_m", "rpe_seconds_translation_m"}) {
      std::vector<double> values;
      for (const ordered_json* row : runs[own]) {
        const ordered_json& value = (*row)[figure];
        if (value.is_number()) values.push_back(1000.0 * value.get<double>());
      }
      for (const double share : {0.5, 0.0, 1.0}) {
        cells.push_back(
            values.empty() ? "-" : Format("%.2f", Quantile(values, share)));
      }
    }
    rows.push_back(std::move(cells));
  }
  return FormatColumns(rows, names.size());
}

}  // namespace

BatchSummary Summarise(const std::vector<BatchRun>& runs,
                       const BatchFolder& folder) {
  BatchSummary summary;
  for (const BatchRun& run : runs) {
    const std::optional<RunEnd> end = folder.ReadEnd(run);
    ordered_json row = {{"sequence", run.sequence.name}};
    for (size_t k = 0; k < run.values.size(); ++k) {
      row[BatchSettings()[k].column] = run.values[k];
    }
    row["repeat"] = run.repeat;
    row["status"] = end ? end->status : "missing";
    row["exit_code"] = end ? ordered_json(end->exit_code) : nullptr;
    row["folder"] = run.Name();
    const json metrics = end ? ReadMetrics(folder.Complete(run)) : json();
    for (const auto& [column, place] : kFigures) {
      row[column] = FindFigure(metrics, place);
    }
    summary.push_back(row);
  }
  return summary;
}

std::string FormatBatchCsv(const BatchSummary& summary) {
  std::string text = "sequence";
  for (const BatchSetting& setting : BatchSettings()) {
    text += std::string(",") + setting.column;
  }
  text += ",repeat,status,exit_code,folder";
  for (const auto& figure : kFigures) text += std::string(",") + figure.name;
  text += "\n";
  for (const ordered_json& row : summary) {
    std::string line;
    for (const ordered_json& value : row) line += "," + FormatCell(value);
    text += line.substr(1) + "\n";
  }
  return text;
}

std::string FormatBatchJson(const BatchSummary& summary) {
  // Invalid UTF-8 in a name must not make the summary fail.
  return ordered_json(summary).dump(2, ' ', false,
                                    json::error_handler_t::replace) +
         "\n";
}

std::string FormatBatchTable(const BatchSummary& summary) {
  std::vector<std::string> same;
  std::vector<std::string> names = {"sequence"};
  bool has_parts = false;
  for (const BatchSetting& setting : BatchSettings()) {
    if (!IsVaried(summary, setting.column)) {
      const std::string value =
          summary.empty() ? "" : FormatCell(summary[0][setting.column]);
      if (value.empty()) continue;
      same.push_back(std::string(setting.column) + " " + value);
    } else if (setting.column == std::string("part")) {
      has_parts = true;  // treated as repeats of each other
    } else {
      names.push_back(setting.column);
    }
  }
  return (same.empty() ? "" : "the same in all runs: " + Join(same) + "\n") +
         (has_parts ? TableOfParts(summary, names)
                    : TableOfRuns(summary, std::move(names)));
}

}  // namespace rgbd_pose
