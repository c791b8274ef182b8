# find_package(deltarobot) gives the targets deltarobot::deltarobot, the static library, and deltarobot::shared.
if(TARGET deltarobot::deltarobot)
  return()
endif()

# From where this file lies, symbolic links resolved, to the rest of what was installed with it.
get_filename_component(_deltarobot_here "${CMAKE_CURRENT_LIST_DIR}" REALPATH)
get_filename_component(_deltarobot_prefix "@CMAKE_PREFIX@" ABSOLUTE)
get_filename_component(_deltarobot_libdir "${_deltarobot_here}/../.." ABSOLUTE)

# The sizes that the library was built for.@CMAKE_SIZES@

add_library(deltarobot::deltarobot STATIC IMPORTED)
set_target_properties(deltarobot::deltarobot PROPERTIES
  IMPORTED_LOCATION "${_deltarobot_libdir}/libdeltarobot.a"
  INTERFACE_INCLUDE_DIRECTORIES "@INCLUDEDIR@")

# Bare metal has no shared library.
if(EXISTS "${_deltarobot_libdir}/libdeltarobot.so.@VERSION@")
  add_library(deltarobot::shared SHARED IMPORTED)
  set_target_properties(deltarobot::shared PROPERTIES
    IMPORTED_LOCATION "${_deltarobot_libdir}/libdeltarobot.so.@VERSION@"
    IMPORTED_SONAME libdeltarobot.so.@MAJOR@
    INTERFACE_INCLUDE_DIRECTORIES "@INCLUDEDIR@")
endif()

unset(_deltarobot_here)
unset(_deltarobot_prefix)
unset(_deltarobot_libdir)
