# The target OpenNI2::OpenNI2, if OpenNI 2 is found (it has no CMake package).
# Installed as well, because a static rgbd_pose::frontend links it.
find_library(OPENNI2_LIBRARY OpenNI2)
find_path(OPENNI2_INCLUDE_DIR OpenNI.h PATH_SUFFIXES openni2)
mark_as_advanced(OPENNI2_LIBRARY OPENNI2_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  OpenNI2 REQUIRED_VARS OPENNI2_LIBRARY OPENNI2_INCLUDE_DIR)

if(OpenNI2_FOUND AND NOT TARGET OpenNI2::OpenNI2)
  add_library(OpenNI2::OpenNI2 UNKNOWN IMPORTED)
  set_target_properties(OpenNI2::OpenNI2 PROPERTIES
    IMPORTED_LOCATION ${OPENNI2_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES ${OPENNI2_INCLUDE_DIR})
endif()
