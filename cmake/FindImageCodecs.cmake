# The target ImageCodecs::ImageCodecs: libjpeg-turbo's TurboJPEG and libspng.
# Installed as well, because a static rgbd_pose::frontend links it.
find_library(TURBOJPEG_LIBRARY turbojpeg)
find_path(TURBOJPEG_INCLUDE_DIR turbojpeg.h)
find_library(SPNG_LIBRARY spng)
find_path(SPNG_INCLUDE_DIR spng.h)
mark_as_advanced(TURBOJPEG_LIBRARY TURBOJPEG_INCLUDE_DIR SPNG_LIBRARY
                 SPNG_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  ImageCodecs REQUIRED_VARS TURBOJPEG_LIBRARY TURBOJPEG_INCLUDE_DIR
                            SPNG_LIBRARY SPNG_INCLUDE_DIR)

if(ImageCodecs_FOUND AND NOT TARGET ImageCodecs::ImageCodecs)
  add_library(ImageCodecs::ImageCodecs INTERFACE IMPORTED)
  set_target_properties(ImageCodecs::ImageCodecs PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${TURBOJPEG_INCLUDE_DIR};${SPNG_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${TURBOJPEG_LIBRARY};${SPNG_LIBRARY}")
endif()
