#pragma once

#include <string>
#include <vector>

namespace rgbd_pose {

// A text table as written by the programs: a line of column names, then rows of
// comma-separated cells. Cells may be in double quotes.
class CsvTable {
 public:
  // Throws InputError if the file cannot be read or the number of cells in a
  // row differs from the number of columns.
  static CsvTable Read(const std::string& path);

  size_t size() const { return rows_.size(); }

  // The cells of a column. Throws InputError if there is no such column.
  std::vector<std::string> Words(const std::string& column) const;

  // The same as finite numbers; NaN if empty. Throws InputError for others.
  std::vector<double> Numbers(const std::string& column) const;

 private:
  std::string path_;
  std::vector<std::string> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace rgbd_pose
