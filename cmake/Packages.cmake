# `cpack -G DEB`: librgbd-pose-dev (libraries, headers), rgbd-pose-tools
# (programs). Only for static libraries: programs must not need a -dev package.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME rgbd-pose)
set(CPACK_PACKAGE_CONTACT "rgbd_pose developers <rgbd_pose@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY ${PROJECT_DESCRIPTION})
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL development tools)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME librgbd-pose-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION
    "Libraries, headers and files for find_package(rgbd_pose) and pkg-config:
costs, M-estimators, frontends and odometry, each a named, swappable piece.")
set(dependencies libceres-dev libeigen3-dev libopencv-dev libyaml-cpp-dev
                 libturbojpeg0-dev libspng-dev)
if(ChunkCodecs_FOUND)
  list(APPEND dependencies libzstd-dev liblz4-dev libbz2-dev)
endif()
if(Libdeflate_FOUND)
  list(APPEND dependencies libdeflate-dev)
endif()
if(SQLite3_FOUND)
  list(APPEND dependencies libsqlite3-dev)
endif()
if(OpenNI2_FOUND)
  list(APPEND dependencies libopenni2-dev)
endif()
if(TARGET OpenEXR::OpenEXR)
  list(APPEND dependencies libopenexr-dev)
endif()
list(JOIN dependencies ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME rgbd-pose-tools)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)
set(CPACK_COMPONENT_TOOLS_DESCRIPTION
    "Programs: visual odometry on sequences in TUM layout, evaluation, batches,
reports and simulated sequences.")

# Debian requires the licence of each package here; other installs have it in
# their own folder of documents.
foreach(component DEVELOPMENT TOOLS)
  string(TOLOWER ${component} name)
  set(folder
      ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${component}_PACKAGE_NAME})
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE RENAME copyright
          DESTINATION ${folder} COMPONENT ${name} EXCLUDE_FROM_ALL)
  install(FILES ${PROJECT_SOURCE_DIR}/third_party_notes.md
          DESTINATION ${folder} COMPONENT ${name} EXCLUDE_FROM_ALL)
endforeach()

include(CPack)
