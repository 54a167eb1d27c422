#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/rigid3.h"
#include "core/pose_graph/relative_pose.h"
#include "frontend/map/stored_images.h"

namespace rgbd_pose {

// A frame that a map keeps, and where it was taken.
struct MapKeyframe {
  int id = 0;            // its name in the map: what edges refer to
  int segment = 0;       // poses of one segment share one frame of reference
  Rigid3d map_from_cam;  // of its segment's part of the map
  StoredImages images;   // with its time
};

// A place as it was seen: keyframes, and the motions measured between them. All
// that is needed to find a camera in it, to go on with it, to correct it.
struct KeyframeMap {
  Camera camera;                       // that took all keyframes
  std::vector<MapKeyframe> keyframes;  // in any order
  std::vector<RelativePose> edges;     // ref and cur: ids of keyframes

  // One line that says what is wrong, or empty: two keyframes with one id,
  // images of another size than the camera's, edges to keyframes that are not
  // there, numbers that are not finite, covariances that are not symmetric and
  // positive definite.
  std::string Check() const;

  // One line that says where another camera differs from the map's, or empty.
  // Frames of another camera do not fit the map.
  std::string CheckCamera(const Camera& other) const;
};

}  // namespace rgbd_pose
