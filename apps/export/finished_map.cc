// A map as something to export: its keyframes are frames of a run.

#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "apps/export/export_format.h"
#include "frontend/slam/map_folder.h"

namespace rgbd_pose {
namespace {

// The keyframes of the largest connected part, in the order of their ids.
std::vector<const Keyframe*> LargestPart(const KeyframeMap& map) {
  std::map<int, std::vector<const Keyframe*>> parts;  // by segment
  for (const Keyframe& keyframe : map.keyframes) {
    parts[keyframe.segment].push_back(&keyframe);
  }
  std::vector<const Keyframe*> largest;
  for (auto& [segment, part] : parts) {
    if (part.size() > largest.size()) largest = std::move(part);
  }
  std::sort(largest.begin(), largest.end(),
            [](const Keyframe* a, const Keyframe* b) { return a->id < b->id; });
  return largest;
}

// The poses and stamps of keyframes. A map that several recordings have made
// can have a time twice: then seconds are counted instead.
Trajectory PathOf(const std::vector<const Keyframe*>& keyframes) {
  Trajectory path;
  for (const Keyframe* keyframe : keyframes) {
    path.push_back({keyframe->images.timestamp, keyframe->world_from_cam});
  }
  const auto is_not_later = [](const StampedPose& a, const StampedPose& b) {
    return !(a.timestamp + kSameTime < b.timestamp);
  };
  if (std::adjacent_find(path.begin(), path.end(), is_not_later) !=
      path.end()) {
    for (size_t i = 0; i < path.size(); ++i) {
      path[i].timestamp = static_cast<double>(i);
    }
  }
  return path;
}

// The direction of up in the world of the path, as its keyframes have measured
// it; zero if none has.
Eigen::Vector3d UpOf(const KeyframeMap& map,
                     const std::vector<const Keyframe*>& keyframes) {
  std::map<int, const Keyframe*> by_id;
  for (const Keyframe* keyframe : keyframes) by_id[keyframe->id] = keyframe;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const MapUp& up : map.ups) {
    const auto found = by_id.find(up.keyframe);
    if (found == by_id.end()) continue;
    sum += found->second->world_from_cam.rotation * up.in_cam /
           (up.sigma * up.sigma);
  }
  return sum;
}

// Images of keyframes as the frames of a recording.
class MapFrames final : public Dataset {
 public:
  MapFrames(std::shared_ptr<const KeyframeMap> map, Trajectory path,
            std::vector<const Keyframe*> keyframes)
      : map_(std::move(map)),
        path_(std::move(path)),
        keyframes_(std::move(keyframes)) {
    camera_.camera = map_->camera;
  }

  int size() const override { return static_cast<int>(path_.size()); }
  double timestamp(int index) const override { return path_[index].timestamp; }
  const RgbdCamera& camera() const override { return camera_; }

  Frame Read(int index) const override {
    Frame frame = keyframes_[index]->images.Restore();
    frame.index = index;
    frame.timestamp = timestamp(index);
    cv::cvtColor(frame.gray, frame.color, cv::COLOR_GRAY2BGR);
    return frame;
  }

 private:
  std::shared_ptr<const KeyframeMap> map_;  // has the keyframes
  Trajectory path_;
  std::vector<const Keyframe*> keyframes_;
  RgbdCamera camera_;
};

}  // namespace

FinishedRun MapAsRun(const std::string& folder) {
  const auto map = std::make_shared<const KeyframeMap>(LoadMap(folder));
  if (map->keyframes.empty()) {
    throw InputError("--map: " + folder + ": the map has no keyframes");
  }
  const std::vector<const Keyframe*> keyframes = LargestPart(*map);
  const Trajectory path = PathOf(keyframes);
  FinishedRun run(path, [map, path, keyframes] {
    return std::make_unique<MapFrames>(map, path, keyframes);
  });
  run.map = map;
  run.sequence.dataset = folder;
  for (size_t i = 0; i < keyframes.size(); ++i) {
    run.frames[i] = keyframes[i]->id;
  }
  const Eigen::Vector3d up = UpOf(*map, keyframes);
  if (!up.isZero()) run.level_from_world = LevelFromWorld(up);
  return run;
}

}  // namespace rgbd_pose
