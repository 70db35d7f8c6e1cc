# find_package(luminav-lcmtypes): the target luminav::lcmtypes, the messages in C++ with bounded decoders, and LCM.
include(${CMAKE_CURRENT_LIST_DIR}/find_lcm.cmake)
if(NOT TARGET luminav::lcmtypes)
  set(luminav_lcmtypes_headers ${CMAKE_CURRENT_LIST_DIR}/generated)  # in a build folder
  if(NOT EXISTS ${luminav_lcmtypes_headers})
    get_filename_component(luminav_lcmtypes_headers ${CMAKE_CURRENT_LIST_DIR}/../../../include/luminav-lcmtypes ABSOLUTE)
  endif()
  add_library(luminav::lcmtypes INTERFACE IMPORTED)
  # LCM 1.3.1 writes doubles through int64_t*: inlined at -O2 beside their use, decoded doubles would read 0.
  set_target_properties(luminav::lcmtypes PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES ${luminav_lcmtypes_headers}
    INTERFACE_COMPILE_OPTIONS -fno-strict-aliasing
    INTERFACE_LINK_LIBRARIES lcm::lcm)
endif()
