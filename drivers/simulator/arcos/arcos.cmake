# The simulated microcontroller; shares the codec with the driver, nothing else.
add_library(luminav_arcos STATIC
  ${CMAKE_CURRENT_LIST_DIR}/arcos_controller.cpp ${CMAKE_CURRENT_LIST_DIR}/arcos_motion.cpp
  ${CMAKE_CURRENT_LIST_DIR}/arcos_sonar.cpp)
add_library(luminav::arcos ALIAS luminav_arcos)
target_link_libraries(luminav_arcos PUBLIC luminav::geometry luminav::arcos_codec)
