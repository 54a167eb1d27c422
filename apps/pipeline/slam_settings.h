#pragma once

#include <string>
#include <vector>

#include "apps/pipeline/setting_table.h"
#include "frontend/mapping/mapper.h"

namespace rgbd_pose {

// What a Slam is made of besides its odometry.
struct SlamSettings {
  MappingOptions mapping;  // which keyframes are joined to which

  // What is found out behind the tracking is taken up so many frames after the
  // keyframe that it follows from, and waited for if it is late: so results do
  // not depend on the speed of a machine.
  int update_delay = 10;
};

// Their rows.
std::vector<Setting> SettingTable(SlamSettings* settings);

// Maps, as users say them; empty: none.
struct MapSettings {
  std::string save_map;        // folder
  std::string load_map;        // folders, separated by commas
  bool localise_only = false;  // the loaded map stays as it is
};

// Their rows.
std::vector<Setting> SettingTable(MapSettings* settings);

}  // namespace rgbd_pose
