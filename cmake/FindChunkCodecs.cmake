# The target ChunkCodecs::ChunkCodecs, if libzstd, liblz4 and libbz2 are all
# found. Installed as well, because a static rgbd_pose::frontend links it.
find_library(ZSTD_LIBRARY zstd)
find_path(ZSTD_INCLUDE_DIR zstd.h)
find_library(LZ4_LIBRARY lz4)
find_path(LZ4_INCLUDE_DIR lz4frame.h)
find_library(BZ2_LIBRARY bz2)
find_path(BZ2_INCLUDE_DIR bzlib.h)
mark_as_advanced(ZSTD_LIBRARY ZSTD_INCLUDE_DIR LZ4_LIBRARY LZ4_INCLUDE_DIR
                 BZ2_LIBRARY BZ2_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  ChunkCodecs REQUIRED_VARS ZSTD_LIBRARY ZSTD_INCLUDE_DIR LZ4_LIBRARY
                            LZ4_INCLUDE_DIR BZ2_LIBRARY BZ2_INCLUDE_DIR)

if(ChunkCodecs_FOUND AND NOT TARGET ChunkCodecs::ChunkCodecs)
  add_library(ChunkCodecs::ChunkCodecs INTERFACE IMPORTED)
  set_target_properties(ChunkCodecs::ChunkCodecs PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${ZSTD_INCLUDE_DIR};${LZ4_INCLUDE_DIR};${BZ2_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${ZSTD_LIBRARY};${LZ4_LIBRARY};${BZ2_LIBRARY}")
endif()
