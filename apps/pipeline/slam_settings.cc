#include "apps/pipeline/slam_settings.h"

namespace rgbd_pose {

std::vector<Setting> SettingTable(SlamSettings* settings) {
  constexpr std::string_view kGroup = "Mapping";
  MappingOptions* mapping = &settings->mapping;
  return {
      {"max_pairs", kGroup,
       "older keyframes that see the same, with which a new one is matched",
       &mapping->max_pairs},
      {"min_pair_share", kGroup,
       "share of the view (0 to 1) that two keyframes must have in common",
       &mapping->min_pair_share},
      {"max_loop_candidates", kGroup,
       "keyframes that look alike and are asked whether they show the same "
       "place; 0: loops are found by pose alone",
       &mapping->max_loop_candidates},
      {"drift", kGroup,
       "what a loop may correct: standard deviation as a share of the way and "
       "of the turns",
       &mapping->drift},
      {"window", kGroup,
       "keyframes whose poses are solved for at each new one; after a loop all "
       "are",
       &mapping->window},
      {"update_delay", kGroup, "latency of map updates, in frames",
       &settings->update_delay},
  };
}

std::vector<Setting> SettingTable(MapSettings* settings) {
  constexpr std::string_view kGroup = "Maps";
  return {
      {"save_map", kGroup, "folder to keep the map in; empty: it is not kept",
       Text(&settings->save_map)},
      {"load_map", kGroup,
       "folder of a map to go on with, or several, separated by commas, to "
       "join",
       Text(&settings->load_map)},
      {"localise_only", kGroup,
       "track within the loaded map, which stays as it is",
       &settings->localise_only},
  };
}

}  // namespace rgbd_pose
