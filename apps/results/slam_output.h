#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/pipeline/slam.h"

namespace rgbd_pose {

// slam.csv: a line a frame: its segment, odom_from_cam, map_from_odom, and what
// was taken up of the work behind.
std::string FormatSlamCsv(const std::vector<SlamFrame>& frames);

// Poses as they were known at the time, map_from_cam. Without frames whose
// segment has become part of another one since: their poses were of another
// world.
std::string FormatOnlineTrajectory(const Slam& slam,
                                   const std::vector<SlamFrame>& frames);

// keyframes.csv: name, time, segment, pose and its covariance.
std::string FormatKeyframesCsv(const KeyframeMap& map,
                               const std::vector<MotionMatrix>& covariances);

// graph.g2o: VERTEX_SE3:QUAT and EDGE_SE3:QUAT as g2o has them, from_from_to
// and its information of [t, vec q] in the axes of the edge's end.
std::string FormatG2o(const KeyframeMap& map);

// For the page: keyframes and pairs.
nlohmann::json SlamToJson(const Slam& slam,
                          const std::vector<SlamFrame>& frames);

// One line on what the map could not be made of, or empty.
std::string SlamWarning(const nlohmann::json& slam);

// What the program prints of it.
std::string FormatSlamSummary(const nlohmann::json& slam);

}  // namespace rgbd_pose
