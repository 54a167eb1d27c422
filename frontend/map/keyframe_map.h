#pragma once

#include <string>
#include <vector>

#include "core/geometry/camera.h"
#include "core/pose_graph/relative_pose.h"
#include "frontend/places/keyframe.h"

namespace rgbd_pose {

// A place as it was seen: keyframes, and the motions measured between them. All
// that is needed to find a camera in it, to go on with it, to correct it.
struct KeyframeMap {
  Camera camera;                    // that took all keyframes
  std::vector<Keyframe> keyframes;  // packed, in any order
  std::vector<RelativePose> edges;  // ref and cur: ids of keyframes

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
