# The target OpenVDB::openvdb, if OpenVDB and TBB are there. (The module that
# comes with it wants all that it may have been built with.)
find_library(OPENVDB_LIBRARY openvdb)
find_path(OPENVDB_INCLUDE_DIR openvdb/openvdb.h)
find_library(OPENVDB_TBB_LIBRARY tbb)
find_path(OPENVDB_TBB_INCLUDE_DIR tbb/tbb.h)
mark_as_advanced(OPENVDB_LIBRARY OPENVDB_INCLUDE_DIR OPENVDB_TBB_LIBRARY
                 OPENVDB_TBB_INCLUDE_DIR)

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(
  OpenVDB REQUIRED_VARS OPENVDB_LIBRARY OPENVDB_INCLUDE_DIR OPENVDB_TBB_LIBRARY
                        OPENVDB_TBB_INCLUDE_DIR)

if(OpenVDB_FOUND AND NOT TARGET OpenVDB::openvdb)
  add_library(OpenVDB::openvdb UNKNOWN IMPORTED)
  set_target_properties(OpenVDB::openvdb PROPERTIES
    IMPORTED_LOCATION ${OPENVDB_LIBRARY}
    INTERFACE_INCLUDE_DIRECTORIES
      "${OPENVDB_INCLUDE_DIR};${OPENVDB_TBB_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${OPENVDB_TBB_LIBRARY};Imath-3_1")
endif()
