# What cpack makes in the build folder from the built tree:
#
#   cpack -G DEB   two Debian packages: the program, and the library with its
#                  headers, as Debian parts them
#   cpack -G TGZ   an archive with both, to be unpacked anywhere
#
# Both are for the distribution that they were built on, whose OpenCV, Boost,
# Ceres, glog, LZ4 and xxHash the program uses.

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PACKAGE_NAME colmap-tsar)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_VENDOR "The TSAR for COLMAP authors")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
# The Python module is made by pip.
set(CPACK_COMPONENTS_ALL runtime development)
set(CPACK_PRE_BUILD_SCRIPTS
  ${PROJECT_SOURCE_DIR}/packaging/debian_files.cmake
  ${PROJECT_SOURCE_DIR}/packaging/archive_files.cmake)

string(TOLOWER "${CMAKE_SYSTEM_NAME}-${CMAKE_SYSTEM_PROCESSOR}" tsar_system)
set(CPACK_PACKAGE_FILE_NAME colmap-tsar-${PROJECT_VERSION}-${tsar_system})
set(CPACK_ARCHIVE_COMPONENT_INSTALL OFF)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
# Who makes packages for others gives an address of his own.
set(CPACK_DEBIAN_PACKAGE_MAINTAINER
  "The TSAR for COLMAP authors <colmap-tsar@example.org>" CACHE STRING
  "Who answers for the Debian packages")

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME colmap-tsar)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "colmap (>= 3.7)")
# Of both descriptions, the first line is the summary.
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "\
completes the depth maps of COLMAP on surfaces without texture
The command tsar_refine works between patch_match_stereo and stereo_fusion
of COLMAP: it removes wrong depths, spreads right ones and fits planes to
walls, floors and facades. Other commands make depth maps from images,
import those of other programs, draw reports and score results. It uses
NVIDIA GPUs where it was built with CUDA, and runs on CPUs elsewhere.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libcolmap-tsar-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "\
libboost-program-options-dev, libceres-dev, libeigen3-dev, \
libgoogle-glog-dev, liblz4-dev, libopencv-dev, libxxhash-dev")
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "\
library and headers of TSAR for COLMAP
The static library, the headers and the CMake package ColmapTsar for
programs that call tsar_refine and the other commands themselves.")

include(CPack)
