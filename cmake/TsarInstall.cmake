# Component "runtime": the program, its manual pages and completions, and the
# license. Component "development": the library with its headers, and a package
# config by which other projects find it (find_package(ColmapTsar)).
include(CMakePackageConfigHelpers)

set(TSAR_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/ColmapTsar)

install(TARGETS colmap_tsar_program COMPONENT runtime)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE
  DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/colmap-tsar COMPONENT runtime)

# From here on all is for development.
set(CMAKE_INSTALL_DEFAULT_COMPONENT_NAME development)
install(TARGETS colmap_tsar tsar_commands EXPORT ColmapTsarTargets)
# For C++ sources: without the headers that need OpenCV, nlohmann-json or, where
# nvcc reads them, this project's CUDA part. Only its own sources include those.
set(headers_left_out "")
foreach(tool IN LISTS TSAR_TOOLS_LEFT_OUT)
  list(APPEND headers_left_out PATTERN "tools/${tool}" EXCLUDE
    PATTERN "cli/${tool}_command.h" EXCLUDE)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/colmap_tsar
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h"
  ${headers_left_out}
  PATTERN "base/opencv_threads.h" EXCLUDE
  PATTERN "run/store/json_file.h" EXCLUDE
  PATTERN "device/connected_components.h" EXCLUDE
  PATTERN "device/cuda_*.h" EXCLUDE
  PATTERN "device/parallel_for*.h" EXCLUDE)

install(EXPORT ColmapTsarTargets
  NAMESPACE ColmapTsar:: DESTINATION ${TSAR_PACKAGE_DIR})
configure_package_config_file(
  ${PROJECT_SOURCE_DIR}/cmake/ColmapTsarConfig.cmake.in
  ${PROJECT_BINARY_DIR}/ColmapTsarConfig.cmake
  INSTALL_DESTINATION ${TSAR_PACKAGE_DIR}
  NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(
  ${PROJECT_BINARY_DIR}/ColmapTsarConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
  ${PROJECT_BINARY_DIR}/ColmapTsarConfig.cmake
  ${PROJECT_BINARY_DIR}/ColmapTsarConfigVersion.cmake
  ${PROJECT_SOURCE_DIR}/cmake/TsarImportedTargets.cmake
  DESTINATION ${TSAR_PACKAGE_DIR})
