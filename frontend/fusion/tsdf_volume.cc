#include "frontend/fusion/tsdf_volume.h"

namespace rgbd_pose {

TsdfVolume::Block* TsdfVolume::FindOrInsert(uint64_t key) {
  const auto [place, is_new] = index_.emplace(key, size());
  if (is_new) {
    keys_.push_back(key);
    blocks_.push_back(std::make_unique<Block>());
  }
  return blocks_[place->second].get();
}

int TsdfVolume::Find(uint64_t key) const {
  const auto place = index_.find(key);
  return place == index_.end() ? -1 : place->second;
}

}  // namespace rgbd_pose
