#include "frontend/bags/chunk_codec.h"

#include "core/util/input_error.h"
#ifdef RGBD_POSE_HAS_CHUNK_CODECS
#include <lz4frame.h>
#include <zstd.h>
#endif

namespace rgbd_pose {
namespace {

// No recorder makes chunks of more, and a damaged number is most likely larger.
constexpr uint64_t kMaxSize = uint64_t{1} << 28;

#ifdef RGBD_POSE_HAS_CHUNK_CODECS

bool UnpackZstd(std::string_view packed, std::string* unpacked) {
  return ZSTD_decompress(unpacked->data(), unpacked->size(), packed.data(),
                         packed.size()) == unpacked->size();
}

bool UnpackLz4(std::string_view packed, std::string* unpacked) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) {
    return false;
  }
  size_t taken = 0, given = 0, left = 1;
  while (left != 0) {
    size_t source = packed.size() - taken;
    size_t target = unpacked->size() - given;
    left = LZ4F_decompress(context, unpacked->data() + given, &target,
                           packed.data() + taken, &source, nullptr);
    if (LZ4F_isError(left) || (source == 0 && target == 0)) break;
    taken += source;
    given += target;
  }
  LZ4F_freeDecompressionContext(context);
  return left == 0 && given == unpacked->size();
}

#endif

}  // namespace

std::string Unpack(std::string_view packed, std::string_view codec,
                   uint64_t size) {
  if (codec.empty()) {
    if (packed.size() != size) throw InputError("a chunk is damaged");
    return std::string(packed);
  }
  if (codec != "zstd" && codec != "lz4") {
    throw InputError("is packed by '" + std::string(codec) +
                     "', and only zstd and lz4 are known");
  }
#ifdef RGBD_POSE_HAS_CHUNK_CODECS
  if (size > kMaxSize) throw InputError("a chunk is damaged");
  std::string unpacked(size, '\0');
  const bool is_whole = codec == "zstd" ? UnpackZstd(packed, &unpacked)
                                        : UnpackLz4(packed, &unpacked);
  if (!is_whole) throw InputError("a chunk is damaged");
  return unpacked;
#else
  throw InputError("is packed by " + std::string(codec) +
                   ", which this build does not read; install libzstd-dev and "
                   "liblz4-dev (scripts/install_dependencies formats) and "
                   "build again");
#endif
}

}  // namespace rgbd_pose
