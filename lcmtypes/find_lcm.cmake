# Defines the target lcm::lcm and the program LCM_GEN, which must come from one release: by LCM's own package file (1.4 and
# newer, where CMAKE_PREFIX_PATH or lcm_DIR says), else by its header, library and program (Debian's 1.3.1 has no such file).
if(NOT TARGET lcm::lcm)
  # Not by CMake's registry: every build folder of LCM that this user ever made is noted there.
  find_package(lcm QUIET CONFIG NO_CMAKE_PACKAGE_REGISTRY NO_CMAKE_SYSTEM_PACKAGE_REGISTRY)
  if(lcm_FOUND)
    add_library(lcm::lcm INTERFACE IMPORTED)
    set_target_properties(lcm::lcm PROPERTIES INTERFACE_LINK_LIBRARIES lcm)
    set(LCM_GEN $<TARGET_FILE:lcm-gen>)
  else()
    find_path(LCM_INCLUDE_DIR lcm/lcm-cpp.hpp REQUIRED)
    find_library(LCM_LIBRARY lcm REQUIRED)
    find_program(LCM_GEN lcm-gen REQUIRED)
    add_library(lcm::lcm UNKNOWN IMPORTED)
    set_target_properties(lcm::lcm PROPERTIES
      IMPORTED_LOCATION ${LCM_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LCM_INCLUDE_DIR})
  endif()
endif()
