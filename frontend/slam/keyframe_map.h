#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "frontend/places/keyframe.h"
#include "frontend/slam/map_edge.h"

namespace rgbd_pose {

// Which way is up in the axes of a keyframe, as an accelerometer has measured.
struct MapUp {
  int keyframe = 0;                                   // its id
  Eigen::Vector3d in_cam = Eigen::Vector3d::UnitY();  // of length 1
  double sigma = 0.0;                                 // of its angle, rad
};

// A map of a place: keyframes and the motions measured between them. Contains
// everything needed for relocalisation, to extend the map and to correct it.
struct KeyframeMap {
  Camera camera;                    // of all keyframes
  std::vector<Keyframe> keyframes;  // compressed, in any order
  std::vector<MapEdge> edges;       // each within a segment, in any order
  std::vector<MapUp> ups;           // at most one of a keyframe, in any order

  // A one-line description of an error, or empty: duplicate ids, images of
  // another size than the camera's, edges or directions of missing keyframes,
  // edges between two segments, values that are not finite, covariances that
  // are not symmetric and positive definite.
  std::string Check() const;

  // A one-line description of a difference between `other` and the camera of
  // the map, or empty. Frames of another camera cannot be used with the map.
  std::string CheckCamera(const Camera& other) const;
};

}  // namespace rgbd_pose
