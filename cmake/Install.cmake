# Destinations of `cmake --install`, with files for find_package and pkg-config.
# Component `development`: libraries and headers; `tools`: programs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(RGBD_POSE_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/rgbd_pose)
set(RGBD_POSE_HEADER_DIR ${CMAKE_INSTALL_INCLUDEDIR}/rgbd_pose)

# Installs the headers below a folder, which may be a relative path.
function(rgbd_pose_install_headers folder)
  get_filename_component(folder ${folder} ABSOLUTE)
  file(RELATIVE_PATH to ${PROJECT_SOURCE_DIR} ${folder})
  install(DIRECTORY ${folder}/
          DESTINATION ${RGBD_POSE_HEADER_DIR}/${to} COMPONENT development
          FILES_MATCHING PATTERN *.h)
  install(CODE "set(rgbd_pose_headers ${RGBD_POSE_HEADER_DIR}/${to})"
          COMPONENT development)
  install(SCRIPT ${PROJECT_SOURCE_DIR}/cmake/PrefixIncludes.cmake
          COMPONENT development)
endfunction()

# Installs a library and the headers of its folder. Each library is an export
# set of its own: users of one component only need its dependencies.
function(rgbd_pose_install_library name)
  install(TARGETS rgbd_pose_${name} EXPORT rgbd_pose_${name}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
  rgbd_pose_install_headers(${CMAKE_CURRENT_SOURCE_DIR})
  install(EXPORT rgbd_pose_${name} NAMESPACE rgbd_pose::
          FILE rgbd_pose_${name}.cmake
          DESTINATION ${RGBD_POSE_CMAKE_DIR} COMPONENT development)
  export(EXPORT rgbd_pose_${name} NAMESPACE rgbd_pose::
         FILE ${PROJECT_BINARY_DIR}/rgbd_pose_${name}.cmake)
endfunction()

function(rgbd_pose_install_program name)
  install(TARGETS ${name} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
                                  COMPONENT tools)
endfunction()

# The page of a program for man, and its completions for bash and zsh. Debian's
# zsh does not read the usual folder below /usr, so it is none of the package.
function(rgbd_pose_install_pages man bash zsh)
  set(share ${CMAKE_INSTALL_DATADIR})
  install(FILES ${man} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT tools)
  install(FILES ${bash} DESTINATION ${share}/bash-completion/completions
          COMPONENT tools)
  install(FILES ${zsh} DESTINATION ${share}/zsh/site-functions COMPONENT zsh)
  install(FILES ${zsh} DESTINATION ${share}/zsh/vendor-completions
          COMPONENT tools EXCLUDE_FROM_ALL)
endfunction()

# Installs the package's files; those for find_package serve the build tree,
# too.
function(rgbd_pose_install_package)
  set(source ${PROJECT_SOURCE_DIR}/cmake)
  set(binary ${PROJECT_BINARY_DIR})
  set(RGBD_POSE_OPENCV)
  if(RGBD_POSE_VIDEO)
    set(RGBD_POSE_OPENCV videoio)
  endif()
  set(RGBD_POSE_OPTIONAL)
  foreach(package Libdeflate ChunkCodecs SQLite3 OpenNI2 OpenEXR)
    if(${package}_FOUND)
      list(APPEND RGBD_POSE_OPTIONAL ${package})
    endif()
  endforeach()
  configure_file(${source}/rgbd_poseConfig.cmake.in
                 ${binary}/rgbd_poseConfig.cmake @ONLY)
  write_basic_package_version_file(${binary}/rgbd_poseConfigVersion.cmake
                                   COMPATIBILITY SameMajorVersion)
  set(finders)
  foreach(finder FindImageCodecs FindLibdeflate FindChunkCodecs FindOpenNI2)
    configure_file(${source}/${finder}.cmake ${binary}/${finder}.cmake COPYONLY)
    list(APPEND finders ${binary}/${finder}.cmake)
  endforeach()
  install(FILES ${binary}/rgbd_poseConfig.cmake
                ${binary}/rgbd_poseConfigVersion.cmake
                ${finders}
          DESTINATION ${RGBD_POSE_CMAKE_DIR} COMPONENT development)
  rgbd_pose_configure_pkg_config(${source}/rgbd_pose.pc.in
                                 ${binary}/rgbd_pose.pc)
  configure_file(${source}/rgbd_pose_simulation.pc.in
                 ${binary}/rgbd_pose_simulation.pc @ONLY)
  install(FILES ${binary}/rgbd_pose.pc ${binary}/rgbd_pose_simulation.pc
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
  # Pages and the targets of their links.
  foreach(file CHANGELOG.md CITATION.cff CONTRIBUTING.md LICENSE README.md
               third_party_notes.md)
    install(FILES ${PROJECT_SOURCE_DIR}/${file}
            DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development)
  endforeach()
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs
          DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT development
          PATTERN Doxyfile EXCLUDE
          PATTERN doxygen_filter.awk EXCLUDE)
endfunction()

# Lists the targets' public dependencies. All other dependencies must be linked
# explicitly only if the libraries are static.
function(rgbd_pose_configure_pkg_config input output)
  file(RELATIVE_PATH RGBD_POSE_PC_PREFIX
       ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
  string(REGEX REPLACE "/$" "" RGBD_POSE_PC_PREFIX "${RGBD_POSE_PC_PREFIX}")
  set(requires eigen3 libglog)
  set(requires_private yaml-cpp libturbojpeg spng)
  if(Libdeflate_FOUND)
    list(APPEND requires_private libdeflate)
  endif()
  if(ChunkCodecs_FOUND)
    list(APPEND requires_private libzstd liblz4)
  endif()
  if(SQLite3_FOUND)
    list(APPEND requires_private sqlite3)
  endif()
  if(OpenNI2_FOUND)
    list(APPEND requires_private libopenni2)
  endif()
  if(TARGET OpenEXR::OpenEXR)
    list(APPEND requires_private OpenEXR)
  endif()
  if(NOT BUILD_SHARED_LIBS)
    list(APPEND requires ${requires_private})
    set(requires_private)
  endif()
  # Libraries without a usable pkg-config file.
  set(RGBD_POSE_PC_LIBS)
  if(ChunkCodecs_FOUND AND NOT BUILD_SHARED_LIBS)
    set(RGBD_POSE_PC_LIBS -lbz2)
  endif()
  if(RGBD_POSE_VIDEO AND NOT BUILD_SHARED_LIBS)
    string(APPEND RGBD_POSE_PC_LIBS " -lopencv_videoio")
  endif()
  list(TRANSFORM OpenCV_INCLUDE_DIRS PREPEND -I OUTPUT_VARIABLE flags)
  if(RGBD_POSE_EIGEN_ALIGN)
    list(APPEND flags -DRGBD_POSE_EIGEN_ALIGN=${RGBD_POSE_EIGEN_ALIGN})
  endif()
  list(JOIN requires " " RGBD_POSE_PC_REQUIRES)
  list(JOIN requires_private " " RGBD_POSE_PC_REQUIRES_PRIVATE)
  list(JOIN flags " " RGBD_POSE_PC_CFLAGS)
  configure_file(${input} ${output} @ONLY)
endfunction()
