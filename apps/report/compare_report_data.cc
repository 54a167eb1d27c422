#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/compare/compare_sequence.h"
#include "apps/compare/compare_sweep.h"
#include "apps/report/report_data.h"
#include "apps/shell/csv_table.h"
#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

using nlohmann::json;

// The rows of paths.csv for one path, as numeric columns.
struct PathRows {
  std::string sequence;
  std::string loss;
  std::map<std::string, std::vector<double>> columns;

  size_t size() const { return columns.at("timestamp").size(); }
};

std::vector<PathRows> ReadPaths(const std::string& file) {
  const CsvTable table = CsvTable::Read(file);
  std::map<std::string, std::vector<double>> columns;
  for (const std::string& name : SplitText(kPathColumns, ',')) {
    columns[name] = table.Numbers(name);
  }
  const std::vector<std::string> sequences = table.Words("sequence");
  const std::vector<std::string> losses = table.Words("loss");
  std::vector<PathRows> paths;
  for (size_t i = 0; i < table.size(); ++i) {
    if (paths.empty() || paths.back().sequence != sequences[i] ||
        paths.back().loss != losses[i]) {
      paths.push_back({sequences[i], losses[i], {}});
    }
    for (const auto& [name, numbers] : columns) {
      paths.back().columns[name].push_back(numbers[i]);
    }
  }
  return paths;
}

// The downward axis of the first known camera pose of a path, in world
// coordinates: cameras are assumed to be upright.
json Down(const PathRows& path) {
  for (size_t i = 0; i < path.size(); ++i) {
    const Eigen::Quaterniond rotation(
        path.columns.at("qw")[i], path.columns.at("qx")[i],
        path.columns.at("qy")[i], path.columns.at("qz")[i]);
    if (!rotation.coeffs().allFinite()) continue;
    const Eigen::Vector3d down = rotation * Eigen::Vector3d::UnitY();
    return {down.x(), down.y(), down.z()};
  }
  return {0.0, 1.0, 0.0};
}

json PathColumns(const PathRows& rows, const ReportThinning& thinning) {
  json path;
  for (const char* name : {"x", "y", "z"}) {
    path[name] = thinning.First(rows.columns.at(name), 5);
  }
  if (rows.loss == kTruthName) return path;
  for (const char* name : {"distance_m", "rpe_seconds_m"}) {
    path[name] = thinning.Largest(rows.columns.at(name), 6);
  }
  for (const char* name : {"angle_deg", "rpe_seconds_deg"}) {
    path[name] = thinning.Largest(rows.columns.at(name), 5);
  }
  return path;
}

// Rows of tables.csv: [sequence][loss] = {figure: number}; NaN if unknown.
json Figures(const CsvTable& table) {
  const std::vector<std::string> sequences = table.Words("sequence");
  const std::vector<std::string> losses = table.Words("loss");
  json figures;
  for (const std::string& name : SplitText(kSequenceFigures, ',')) {
    const std::vector<double> numbers = table.Numbers(name);
    for (size_t i = 0; i < numbers.size(); ++i) {
      figures[sequences[i]][losses[i]][name] = numbers[i];
    }
  }
  return figures;
}

json Sequences(const std::string& tables_file, const std::string& paths_file) {
  const json figures = Figures(CsvTable::Read(tables_file));
  const std::vector<PathRows> paths = ReadPaths(paths_file);
  const size_t max_points = std::max<size_t>(
      1, kMaxComparedPoints / std::max<size_t>(1, paths.size()));
  json sequences = json::array();
  for (const PathRows& rows : paths) {
    const ReportThinning thinning(rows.size(), max_points);
    if (sequences.empty() || sequences.back().at("name") != rows.sequence) {
      sequences.push_back(
          {{"name", rows.sequence},
           {"num_frames", rows.size()},
           {"every", thinning.every},
           {"down", Down(rows)},
           {"t", thinning.First(Elapsed(rows.columns.at("timestamp")), 4)},
           {"losses", json::array()}});
    }
    json& sequence = sequences.back();
    if (rows.size() != sequence.at("num_frames")) {
      throw InputError(paths_file + ": " + rows.loss +
                       " has a different number of rows than the path before; "
                       "repeat the comparison");
    }
    json path = PathColumns(rows, thinning);
    if (rows.loss == kTruthName) {
      sequence["truth"] = path;
      continue;
    }
    if (!figures.contains(rows.sequence) ||
        !figures.at(rows.sequence).contains(rows.loss)) {
      throw InputError(tables_file + ": no row of " + rows.loss + " on " +
                       rows.sequence + "; repeat the comparison");
    }
    path["name"] = rows.loss;
    path["figures"] = figures.at(rows.sequence).at(rows.loss);
    sequence["losses"].push_back(path);
  }
  return sequences;
}

json BandColumns(const std::vector<SweepCell>& cells,
                 MedianBand SweepCell::*band) {
  json columns;
  for (const SweepCell& cell : cells) {
    const MedianBand& own = cell.*band;
    columns["median"].push_back(own.median);
    columns["low"].push_back(own.low);
    columns["high"].push_back(own.high);
    columns["p90"].push_back(own.p90);
  }
  return columns;
}

// All methods with their errors at all shares.
json Methods(const std::vector<SweepCell>& cells) {
  json methods = json::array();
  for (const SweepMethod& method : SweepMethods(LossesOf(cells))) {
    const std::vector<SweepCell> own = CellsOf(cells, method);
    methods.push_back(
        {{"loss", method.loss},
         {"schedule", method.schedule},
         {"ransac", method.ransac},
         {"translation_mm", BandColumns(own, &SweepCell::translation_mm)},
         {"rotation_deg", BandColumns(own, &SweepCell::rotation_deg)}});
  }
  return methods;
}

}  // namespace

json CompareReportData(const std::string& folder) {
  const auto file = [&folder](const char* name) {
    return (std::filesystem::path(folder) / name).string();
  };
  json data = {{"settings", ReadReportSettings(file("config.flags"))}};
  // The folder may hold files of both kinds from successive comparisons.
  if (SettingOf(data["settings"], "experiment") == "sweep") {
    const std::vector<SweepCell> cells = ReadSweepCsv(file("sweep.csv"));
    for (int i = 0; i < kSweepShares; ++i) {
      data["wrong_percent"].push_back(std::round(SweepShare(i) * 100.0));
    }
    data["methods"] = Methods(cells);
    data["verdict"] = SweepVerdict(cells);
  } else {
    data["sequences"] = Sequences(file("tables.csv"), file("paths.csv"));
  }
  return data;
}

}  // namespace rgbd_pose
