#include "frontend/bags/mcap_format.h"

#ifdef RGBD_POSE_HAS_LIBDEFLATE
#include <libdeflate.h>
#endif

namespace rgbd_pose {

uint32_t McapChecksum([[maybe_unused]] std::string_view bytes) {
#ifdef RGBD_POSE_HAS_LIBDEFLATE
  return libdeflate_crc32(0, bytes.data(), bytes.size());
#else
  return 0;
#endif
}

}  // namespace rgbd_pose
