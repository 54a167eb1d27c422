#include "frontend/fusion/tsdf_volume.h"

namespace rgbd_pose {
namespace {

constexpr int kBlockBits = 21;
constexpr uint64_t kBlockMask = (uint64_t{1} << kBlockBits) - 1;

}  // namespace

uint64_t TsdfVolume::KeyOf(const Eigen::Vector3i& block) {
  uint64_t key = 0;
  for (int i = 0; i < 3; ++i) {
    key = key << kBlockBits | static_cast<uint64_t>(block[i] + kHalfRange);
  }
  return key;
}

Eigen::Vector3i TsdfVolume::BlockOf(uint64_t key) {
  Eigen::Vector3i block;
  for (int i = 2; i >= 0; --i, key >>= kBlockBits) {
    block[i] = static_cast<int>(key & kBlockMask) - kHalfRange;
  }
  return block;
}

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
