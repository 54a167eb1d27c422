# Manual pages and completions for shells, which each program prints from its
# own table of flags. They are in build/share as later in the prefix.

# Tells the source of manual pages which programs there are, and the day of the
# release: the day of the build would give other bytes every day.
function(rgbd_pose_describe_programs source)
  file(GLOB programs CONFIGURE_DEPENDS rgbd_*.cc)
  list(TRANSFORM programs REPLACE ".*/(.*)\\.cc" "\\1")
  list(JOIN programs " " programs)
  set(citation ${PROJECT_SOURCE_DIR}/CITATION.cff)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${citation})
  file(STRINGS ${citation} date REGEX "^date-released: ")
  string(REPLACE "date-released: " "" date "${date}")
  set_source_files_properties(
    ${source} PROPERTIES COMPILE_DEFINITIONS
    "RGBD_POSE_PROGRAMS=\"${programs}\";RGBD_POSE_DATE=\"${date}\"")
endfunction()

# A program for another kind of machine cannot be run here, and has no pages.
function(rgbd_pose_program_pages name)
  if(CMAKE_CROSSCOMPILING AND NOT CMAKE_CROSSCOMPILING_EMULATOR)
    return()
  endif()
  set(share ${PROJECT_BINARY_DIR}/share)
  set(man ${share}/man/man1/${name}.1)
  set(bash ${share}/bash-completion/completions/${name})
  set(zsh ${share}/zsh/site-functions/_${name})
  foreach(form man bash zsh)
    get_filename_component(folder ${${form}} DIRECTORY)
    file(MAKE_DIRECTORY ${folder})
    add_custom_command(OUTPUT ${${form}} DEPENDS ${name} VERBATIM
                       COMMAND ${name} --help=${form} > ${${form}})
  endforeach()
  add_custom_target(${name}_pages ALL DEPENDS ${man} ${bash} ${zsh})
  if(RGBD_POSE_INSTALL)
    rgbd_pose_install_pages(${man} ${bash} ${zsh})
  endif()
endfunction()
