#include "frontend/bags/chunk_codec.h"

#include <fstream>
#include <functional>
#include <memory>
#include <vector>

#include "core/util/input_error.h"
#include "frontend/bags/wire_reader.h"
#ifdef RGBD_POSE_HAS_CHUNK_CODECS
#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>
#endif

namespace rgbd_pose {
namespace {

// Bytes. No recorder makes larger chunks; most damaged sizes are larger.
constexpr uint64_t kMaxSize = uint64_t{1} << 28;

#ifdef RGBD_POSE_HAS_CHUNK_CODECS

bool UnpackLz4(std::string_view packed, std::string* unpacked) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) {
    return false;
  }
  size_t source = packed.size();
  size_t target = unpacked->size();
  const size_t left = LZ4F_decompress(context, unpacked->data(), &target,
                                      packed.data(), &source, nullptr);
  LZ4F_freeDecompressionContext(context);
  return left == 0 && target == unpacked->size();
}

bool UnpackBz2(std::string_view packed, std::string* unpacked) {
  auto size = static_cast<unsigned>(unpacked->size());
  // The library does not change its input despite the non-const pointer.
  return BZ2_bzBuffToBuffDecompress(
             unpacked->data(), &size, const_cast<char*>(packed.data()),
             static_cast<unsigned>(packed.size()), 0, 0) == BZ_OK &&
         size == unpacked->size();
}

// Decompresses zstd frames piece by piece. `read` fills a buffer and returns
// how much of it, 0 at the end; `write` takes a piece. Returns false if the
// frames are damaged or cut off.
bool UnpackZstd(
    const std::function<size_t(char* to, size_t size)>& read,
    const std::function<void(const char* piece, size_t size)>& write) {
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(
      ZSTD_createDStream(), ZSTD_freeDStream);
  std::vector<char> from(ZSTD_DStreamInSize());
  std::vector<char> to(ZSTD_DStreamOutSize());
  size_t left = 1;  // 0 at the end of a frame, or an error
  while (!ZSTD_isError(left)) {
    ZSTD_inBuffer in = {from.data(), read(from.data(), from.size()), 0};
    if (in.size == 0) break;
    // A full buffer may have left a part of the frame inside.
    bool is_full = false;
    while (!ZSTD_isError(left) &&
           (in.pos < in.size || (is_full && left != 0))) {
      ZSTD_outBuffer out = {to.data(), to.size(), 0};
      left = ZSTD_decompressStream(stream.get(), &out, &in);
      write(to.data(), out.pos);
      is_full = out.pos == out.size;
    }
  }
  return left == 0;
}

// The same for a message in memory.
std::string UnpackZstdMessage(std::string_view packed) {
  std::string unpacked;
  const auto read = [&](char* to, size_t size) {
    const size_t count = packed.copy(to, size);
    packed.remove_prefix(count);
    return count;
  };
  const auto write = [&](const char* piece, size_t size) {
    if (unpacked.size() + size > kMaxSize) {
      throw Damaged("cannot be decompressed");
    }
    unpacked.append(piece, size);
  };
  if (!UnpackZstd(read, write)) {
    throw Damaged("cannot be decompressed");
  }
  return unpacked;
}

#endif

}  // namespace

std::string Unpack(std::string_view packed, std::string_view codec,
                   uint64_t size) {
  constexpr char kWhat[] = "a chunk cannot be decompressed";
  if (codec.empty()) {
    if (packed.size() != size) throw Damaged(kWhat);
    return std::string(packed);
  }
  if (codec != "zstd" && codec != "lz4" && codec != "bz2") {
    throw InputError("is compressed with '" + std::string(codec) +
                     "'; only zstd, lz4 and bz2 are supported");
  }
#ifdef RGBD_POSE_HAS_CHUNK_CODECS
  if (size > kMaxSize) throw Damaged(kWhat);
  std::string unpacked(size, '\0');
  const bool is_whole =
      codec == "lz4"   ? UnpackLz4(packed, &unpacked)
      : codec == "bz2" ? UnpackBz2(packed, &unpacked)
                       : ZSTD_decompress(unpacked.data(), size, packed.data(),
                                         packed.size()) == size;
  if (!is_whole) throw Damaged(kWhat);
  return unpacked;
#else
  throw InputError(
      "is compressed with " + std::string(codec) +
      ", which this build does not support; install libzstd-dev, liblz4-dev "
      "and libbz2-dev (scripts/install_dependencies formats) and build again");
#endif
}

std::string UnpackMessage(std::string bytes) {
  if (bytes.rfind("\x28\xB5\x2F\xFD", 0) != 0) return bytes;
#ifdef RGBD_POSE_HAS_CHUNK_CODECS
  // The size of a frame need not be in its header.
  return UnpackZstdMessage(bytes);
#else
  return Unpack(bytes, "zstd", 0);  // throws
#endif
}

void UnpackZstdFile(const std::string& packed,
                    [[maybe_unused]] const std::string& unpacked) {
#ifdef RGBD_POSE_HAS_CHUNK_CODECS
  std::ifstream from(packed, std::ios::binary);
  std::ofstream to(unpacked, std::ios::binary);
  const auto read = [&](char* buffer, size_t size) {
    from.read(buffer, static_cast<std::streamsize>(size));
    return static_cast<size_t>(from.gcount());
  };
  const auto write = [&](const char* piece, size_t size) {
    to.write(piece, static_cast<std::streamsize>(size));
  };
  if (!UnpackZstd(read, write)) {
    throw InputError(packed + ": is damaged or cut off; copy it again");
  }
  to.close();
  if (!to) {
    throw InputError(packed + ": cannot be decompressed to " + unpacked +
                     "; set TMPDIR to a folder with more space");
  }
#else
  Located(packed, [] { Unpack("", "zstd", 0); });
#endif
}

}  // namespace rgbd_pose
