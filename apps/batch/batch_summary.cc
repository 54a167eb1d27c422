#include "apps/batch/batch_summary.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "core/util/format.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

// A column of figures: its name and where metrics.json of a run has it.
struct Figure {
  const char* column;
  const char* pointer;
};

constexpr Figure kFigures[] = {
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
    // From here on they differ from run to run.
    {"track_ms_median", "/run/track_ms_median"},
    {"wall_seconds", "/run/wall_seconds"},
};

// A run that failed may have none.
json ReadMetrics(const std::string& folder) {
  const std::filesystem::path path =
      std::filesystem::path(folder) / "metrics.json";
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return nullptr;
  return json::parse(ReadTextFile(path.string()), nullptr, false);
}

ordered_json FindFigure(const json& metrics, const char* pointer) {
  const json::json_pointer place(pointer);
  if (!metrics.is_object() || !metrics.contains(place)) return nullptr;
  const json& figure = metrics.at(place);
  return figure.is_number() ? ordered_json(figure) : nullptr;
}

ordered_json MakeRow(const BatchRun& run, const BatchFolder& folder) {
  const std::optional<RunEnd> end = folder.ReadEnd(run);
  ordered_json row = {{"sequence", run.sequence.name},
                      {"cost", run.cost},
                      {"loss", run.loss},
                      {"frontend", run.frontend},
                      {"repeat", run.repeat},
                      {"status", end ? end->status : "missing"},
                      {"exit_code", nullptr}};
  if (end) row["exit_code"] = end->exit_code;
  const json metrics = end ? ReadMetrics(folder.Complete(run)) : json();
  for (const Figure& figure : kFigures) {
    row[figure.column] = FindFigure(metrics, figure.pointer);
  }
  return row;
}

// Names of runs hold neither commas nor quotes.
std::string FormatCell(const ordered_json& value) {
  if (value.is_null()) return "";
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string FormatScaled(const ordered_json& value, double factor, int digits) {
  if (!value.is_number()) return "-";
  return Format("%.*f", digits, factor * value.get<double>());
}

}  // namespace

BatchSummary Summarise(const std::vector<BatchRun>& runs,
                       const BatchFolder& folder) {
  BatchSummary summary;
  for (const BatchRun& run : runs) summary.push_back(MakeRow(run, folder));
  return summary;
}

int CountNotOk(const BatchSummary& summary) {
  return static_cast<int>(
      std::count_if(summary.begin(), summary.end(),
                    [](const auto& row) { return row["status"] != "ok"; }));
}

std::string FormatBatchCsv(const BatchSummary& summary) {
  std::string text = "sequence,cost,loss,frontend,repeat,status,exit_code";
  for (const Figure& figure : kFigures) {
    text += std::string(",") + figure.column;
  }
  text += "\n";
  for (const ordered_json& row : summary) {
    std::string line;
    for (const ordered_json& value : row) line += "," + FormatCell(value);
    text += line.substr(1) + "\n";
  }
  return text;
}

std::string FormatBatchJson(const BatchSummary& summary) {
  // A name that is not UTF-8 must not cost the whole summary.
  return ordered_json(summary).dump(2, ' ', false,
                                    json::error_handler_t::replace) +
         "\n";
}

std::string FormatBatchTable(const BatchSummary& summary) {
  std::vector<std::vector<std::string>> rows = {
      {"sequence", "cost", "loss", "frontend", "run", "status", "tracked %",
       "ATE mm", "RPE mm/s", "RPE deg/s", "ms/frame"}};
  for (const ordered_json& row : summary) {
    rows.push_back({FormatCell(row["sequence"]), FormatCell(row["cost"]),
                    FormatCell(row["loss"]), FormatCell(row["frontend"]),
                    FormatCell(row["repeat"]), FormatCell(row["status"]),
                    FormatScaled(row["tracked_share"], 100.0, 1),
                    FormatScaled(row["ate_rmse_m"], 1000.0, 2),
                    FormatScaled(row["rpe_seconds_translation_m"], 1000.0, 2),
                    FormatScaled(row["rpe_seconds_rotation_deg"], 1.0, 3),
                    FormatScaled(row["track_ms_median"], 1.0, 2)});
  }
  std::vector<size_t> widths(rows[0].size());
  for (const auto& row : rows) {
    for (size_t i = 0; i < row.size(); ++i) {
      widths[i] = std::max(widths[i], row[i].size());
    }
  }
  constexpr size_t kFirstFigure = 6;  // figures to the right
  std::string text;
  for (const auto& row : rows) {
    for (size_t i = 0; i < row.size(); ++i) {
      const std::string space(widths[i] - row[i].size(), ' ');
      text += i < kFirstFigure ? row[i] + space : space + row[i];
      text += i + 1 < row.size() ? "  " : "\n";
    }
  }
  return text;
}

}  // namespace rgbd_pose
