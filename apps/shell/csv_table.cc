#include "apps/shell/csv_table.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/util/input_error.h"
#include "core/util/text_file.h"

namespace rgbd_pose {
namespace {

std::vector<std::string> SplitLine(const std::string& line) {
  std::vector<std::string> cells(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  return cells;
}

}  // namespace

CsvTable CsvTable::Read(const std::string& path) {
  CsvTable table;
  table.path_ = path;
  std::istringstream text(ReadTextFile(path));
  std::string line;
  std::getline(text, line);
  table.columns_ = SplitLine(line);
  for (int number = 2; std::getline(text, line); ++number) {
    table.rows_.push_back(SplitLine(line));
    if (table.rows_.back().size() == table.columns_.size()) continue;
    throw InputError(path + ":" + std::to_string(number) + ": " +
                     std::to_string(table.rows_.back().size()) +
                     " cells, but " + std::to_string(table.columns_.size()) +
                     " column names; create the file again");
  }
  return table;
}

std::vector<std::string> CsvTable::Words(const std::string& column) const {
  const size_t place =
      std::find(columns_.begin(), columns_.end(), column) - columns_.begin();
  if (place == columns_.size()) {
    throw InputError(path_ + ":1: no column '" + column +
                     "'; create the file again with this version");
  }
  std::vector<std::string> words;
  for (const std::vector<std::string>& row : rows_) words.push_back(row[place]);
  return words;
}

std::vector<double> CsvTable::Numbers(const std::string& column) const {
  std::vector<double> numbers;
  int line = 2;
  for (const std::string& word : Words(column)) {
    numbers.push_back(word.empty() ? NAN
                                   : ParseNumber(word, path_, line, column));
    ++line;
  }
  return numbers;
}

}  // namespace rgbd_pose
