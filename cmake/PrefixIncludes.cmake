# Run at installation: headers below `rgbd_pose_headers` include each other by
# "rgbd_pose/core/...", as users do. Hence no other "core/..." on the include
# path can replace them.
file(GLOB_RECURSE headers
     "$ENV{DESTDIR}${CMAKE_INSTALL_PREFIX}/${rgbd_pose_headers}/*.h")
foreach(header IN LISTS headers)
  file(READ ${header} text)
  string(REGEX REPLACE "#include \"(core|robust|costs|frontend|apps)/"
         "#include \"rgbd_pose/\\1/" prefixed "${text}")
  if(NOT prefixed STREQUAL text)
    file(WRITE ${header} "${prefixed}")
  endif()
endforeach()
