#include "apps/python/any_factor.h"

#include "core/util/input_error.h"

namespace rgbd_pose {

std::string BlockNames(const AnyFactor& factor) {
  std::string names;
  for (const factors::BlockKind& kind : factor.blocks) {
    names += (names.empty() ? "" : ", ") + std::string(kind.name);
  }
  return names;
}

void CheckBlockCount(const AnyFactor& factor, const std::string& where,
                     size_t count) {
  const size_t needed = factor.blocks.size();
  if (count == needed) return;
  throw InputError(where + ": the factor is over " + std::to_string(needed) +
                   (needed == 1 ? " block (" : " blocks (") +
                   BlockNames(factor) + "), not " + std::to_string(count));
}

}  // namespace rgbd_pose
