#include "frontend/slam/keyframe_map.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <map>
#include <set>

#include "core/util/format.h"

namespace rgbd_pose {
namespace {

// Covers rounding, but is far smaller than the error of a wrong quaternion.
constexpr double kMaxLengthError = 1e-6;

bool IsMotion(const Rigid3d& motion) {
  return motion.IsFinite() &&
         std::abs(motion.rotation.norm() - 1.0) <= kMaxLengthError;
}

bool IsCovariance(const MotionMatrix& matrix) {
  if (!matrix.allFinite() || !matrix.isApprox(matrix.transpose())) return false;
  const Eigen::LLT<MotionMatrix> cholesky(matrix);
  // An overflow gives NaN in the decomposition, but no error status.
  return cholesky.info() == Eigen::Success &&
         cholesky.matrixLLT().diagonal().minCoeff() > 0.0 &&
         cholesky.matrixLLT().allFinite();
}

}  // namespace

std::string KeyframeMap::Check() const {
  const std::string wrong_camera = camera.Check();
  if (!wrong_camera.empty()) return "camera: " + wrong_camera;
  std::map<int, int> segments;  // by the ids of keyframes
  for (const Keyframe& keyframe : keyframes) {
    const std::string name = "keyframe " + std::to_string(keyframe.id) + ": ";
    if (!segments.emplace(keyframe.id, keyframe.segment).second) {
      return name + "appears twice";
    }
    if (!IsMotion(keyframe.world_from_cam)) {
      return name + "the pose must be finite and its quaternion of unit length";
    }
    if (!keyframe.timing_covariance.allFinite()) {
      return name + "the timing covariance must be finite";
    }
    const std::string wrong_images =
        keyframe.images.Check(camera.width, camera.height);
    if (!wrong_images.empty()) return name + wrong_images;
  }
  for (const RelativePose& edge : edges) {
    const std::string name =
        Format("edge from keyframe %d to %d: ", edge.ref, edge.cur);
    for (const int id : {edge.ref, edge.cur}) {
      if (segments.count(id) == 0) {
        return name + "there is no keyframe " + std::to_string(id);
      }
    }
    if (edge.ref == edge.cur) {
      return name + "it must connect two different keyframes";
    }
    if (segments[edge.ref] != segments[edge.cur]) {
      return name + "its keyframes are of two segments; give both the same";
    }
    if (!IsMotion(edge.cur_from_ref)) {
      return name +
             "the motion must be finite and its quaternion of unit length";
    }
    if (!IsCovariance(edge.covariance)) {
      return name + "the covariance must be symmetric and positive definite";
    }
  }
  std::set<int> with_up;
  for (const MapUp& up : ups) {
    const std::string name = Format("up of keyframe %d: ", up.keyframe);
    if (segments.count(up.keyframe) == 0) {
      return name + "there is no such keyframe";
    }
    if (!with_up.insert(up.keyframe).second) return name + "appears twice";
    if (!(std::abs(up.in_cam.norm() - 1.0) <= kMaxLengthError)) {
      return name + "it must be finite and of unit length";
    }
    if (!(up.sigma > 0.0 && std::isfinite(up.sigma))) {
      return name + "sigma must be positive";
    }
  }
  return "";
}

std::string KeyframeMap::CheckCamera(const Camera& other) const {
  if (other.width != camera.width || other.height != camera.height) {
    return Format("the map's images have %d x %d pixels, the camera's %d x %d",
                  camera.width, camera.height, other.width, other.height);
  }
  if (camera.lens_model != other.lens_model) {
    return "one lens is equidistant (fisheye), the other is not";
  }
  for (const auto& [name, value] : kCameraParameters) {
    if (camera.*value != other.*value) {
      return Format("%s is %s in the map, %s in the camera", name,
                    ShortNumber(camera.*value).c_str(),
                    ShortNumber(other.*value).c_str());
    }
  }
  return "";
}

}  // namespace rgbd_pose
