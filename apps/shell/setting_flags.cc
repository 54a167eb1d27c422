#include "apps/shell/setting_flags.h"

#include <gflags/gflags.h>

namespace rgbd_pose {
namespace {

// gflags holds on to both places.
template <typename Value>
void Register(const Setting& setting, Value* current,
              std::deque<Value>* defaults) {
  defaults->push_back(*current);
  gflags::FlagRegisterer(setting.name, setting.help, __FILE__, current,
                         &defaults->back());
}

}  // namespace

SettingFlags::SettingFlags(const std::vector<std::vector<Setting>>& tables) {
  for (const std::vector<Setting>& table : tables) {
    settings_.insert(settings_.end(), table.begin(), table.end());
  }
  for (const Setting& setting : settings_) {
    names_.emplace_back();
    if (int* const* whole = std::get_if<int*>(&setting.value)) {
      Register(setting, *whole, &default_ints_);
    } else if (double* const* real = std::get_if<double*>(&setting.value)) {
      Register(setting, *real, &default_doubles_);
    } else if (bool* const* yes = std::get_if<bool*>(&setting.value)) {
      Register(setting, *yes, &default_bools_);
    } else {
      names_.back() = std::get<NamedSetting>(setting.value).get();
      Register(setting, &names_.back(), &default_names_);
    }
  }
}

void SettingFlags::Describe(ProgramInfo* info) const {
  for (const Setting& setting : settings_) {
    if (info->flag_groups.empty() ||
        info->flag_groups.back().title != setting.group) {
      info->flag_groups.push_back({std::string(setting.group), {}});
    }
    info->flag_groups.back().flags.push_back(setting.name);
    if (!setting.choices.empty()) info->choices[setting.name] = setting.choices;
  }
}

void SettingFlags::Apply() const {
  for (size_t i = 0; i < settings_.size(); ++i) {
    if (auto* named = std::get_if<NamedSetting>(&settings_[i].value)) {
      named->set(names_[i]);
    }
  }
}

}  // namespace rgbd_pose
