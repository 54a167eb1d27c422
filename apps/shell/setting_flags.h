#pragma once

#include <deque>
#include <string>
#include <vector>

#include "apps/pipeline/setting_table.h"
#include "apps/shell/program.h"

namespace rgbd_pose {

// A flag of gflags for each row of some tables of settings. Must live as long
// as flags are read.
class SettingFlags {
 public:
  explicit SettingFlags(const std::vector<std::vector<Setting>>& tables);

  // Adds them to what --help says of a program.
  void Describe(ProgramInfo* info) const;

  // The flags write numbers into the settings themselves; this, when they have
  // been read, sets what goes by name. Throws InputError for unknown names.
  void Apply() const;

 private:
  std::vector<Setting> settings_;
  std::deque<std::string> names_;  // what flags hold, a row each
  // What gflags has as the defaults; in deques, where they stay.
  std::deque<std::string> default_names_;
  std::deque<int> default_ints_;
  std::deque<double> default_doubles_;
  std::deque<bool> default_bools_;
};

}  // namespace rgbd_pose
