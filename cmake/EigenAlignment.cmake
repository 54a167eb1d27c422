# RGBD_POSE_EIGEN_ALIGN: Eigen's alignment in bytes with the flags of this
# build; empty if it is not a usual one. See core/geometry/rigid3.h.
include(CheckCXXSourceCompiles)

function(rgbd_pose_find_eigen_alignment)
  get_target_property(CMAKE_REQUIRED_INCLUDES Eigen3::Eigen
                      INTERFACE_INCLUDE_DIRECTORIES)
  string(TOUPPER "CMAKE_CXX_FLAGS_${CMAKE_BUILD_TYPE}" type_flags)
  set(CMAKE_REQUIRED_FLAGS "${${type_flags}}")
  # The cached result depends on the compiler and its flags.
  string(MD5 hash "${CMAKE_CXX_COMPILER} ${CMAKE_CXX_FLAGS} ${${type_flags}}")
  foreach(bytes 16 32 64)
    check_cxx_source_compiles(
      "#include <Eigen/Core>
       static_assert(EIGEN_MAX_ALIGN_BYTES == ${bytes} &&
                     EIGEN_MAX_STATIC_ALIGN_BYTES == ${bytes}, \"\");
       int main() {}"
      RGBD_POSE_EIGEN_ALIGNS_${bytes}_${hash})
    if(RGBD_POSE_EIGEN_ALIGNS_${bytes}_${hash})
      set(RGBD_POSE_EIGEN_ALIGN ${bytes} PARENT_SCOPE)
      return()
    endif()
  endforeach()
endfunction()
