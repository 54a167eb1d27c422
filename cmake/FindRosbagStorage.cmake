# The target RosbagStorage::RosbagStorage, if the library that writes ROS 1 bags
# is found; catkin is not needed. Used only by tests.
set(rosbag_libraries)
set(rosbag_includes)
foreach(library rosbag_storage roscpp_serialization rostime cpp_common
                console_bridge class_loader ament_index_cpp tinyxml2 roslib
                rcpputils rcutils)
  find_library(ROSBAG_${library}_LIBRARY ${library})
  mark_as_advanced(ROSBAG_${library}_LIBRARY)
  list(APPEND rosbag_libraries ROSBAG_${library}_LIBRARY)
endforeach()
# rosbag/bag.h includes all of these for its decryption plugins. On Debian 12,
# some are in folders of their own.
foreach(header rosbag/bag.h ros/time.h boost/shared_ptr.hpp
               console_bridge/console.h pluginlib/class_loader.hpp
               class_loader/class_loader.hpp rcpputils/shared_library.hpp
               rcutils/macros.h ament_index_cpp/get_resource.hpp)
  string(REGEX REPLACE "[/.].*" "" folder ${header})
  find_path(ROSBAG_${folder}_INCLUDE_DIR ${header} PATH_SUFFIXES ${folder})
  mark_as_advanced(ROSBAG_${folder}_INCLUDE_DIR)
  list(APPEND rosbag_includes ROSBAG_${folder}_INCLUDE_DIR)
endforeach()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  RosbagStorage REQUIRED_VARS ROSBAG_rosbag_storage_LIBRARY
                              ROSBAG_rosbag_INCLUDE_DIR)

if(RosbagStorage_FOUND AND NOT TARGET RosbagStorage::RosbagStorage)
  add_library(RosbagStorage::RosbagStorage INTERFACE IMPORTED)
  # Other versions of ROS need fewer of these.
  foreach(path ${rosbag_includes})
    if(${path})
      set_property(TARGET RosbagStorage::RosbagStorage APPEND PROPERTY
                   INTERFACE_INCLUDE_DIRECTORIES ${${path}})
    endif()
  endforeach()
  foreach(library ${rosbag_libraries})
    if(${library})
      set_property(TARGET RosbagStorage::RosbagStorage APPEND PROPERTY
                   INTERFACE_LINK_LIBRARIES ${${library}})
    endif()
  endforeach()
endif()
