#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "frontend/slam/slam.h"

namespace rgbd_pose {

// slam.csv: segment, odom_from_cam, map_from_odom and map updates per frame.
std::string FormatSlamCsv(const Slam& slam,
                          const std::vector<SlamFrame>& frames);

// The poses map_from_cam as known at the time, without frames whose segment was
// merged into another one later: their poses are in another world.
std::string FormatOnlineTrajectory(const Slam& slam,
                                   const std::vector<SlamFrame>& frames);

// keyframes.csv: id, time, segment, pose and pose covariance.
std::string FormatKeyframesCsv(const KeyframeMap& map,
                               const std::vector<MotionMatrix>& covariances);

// graph.g2o: VERTEX_SE3:QUAT and EDGE_SE3:QUAT as defined by g2o. An edge has
// from_from_to and the information of [t, vec q] in the axes of the edge's end.
std::string FormatG2o(const KeyframeMap& map);

// Keyframes and pairs as JSON, for the page.
nlohmann::json SlamToJson(const Slam& slam,
                          const std::vector<SlamFrame>& frames);

// Describes in one line what is missing in the map, or empty.
std::string SlamWarning(const nlohmann::json& slam);

// Formats the text that the program prints.
std::string FormatSlamSummary(const nlohmann::json& slam);

}  // namespace rgbd_pose
