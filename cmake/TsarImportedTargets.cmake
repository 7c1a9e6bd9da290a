# Targets of the libraries that come without a CMake package on some
# distributions. Part of the installed package too.

if(NOT TARGET ColmapTsar::glog)
  add_library(ColmapTsar::glog INTERFACE IMPORTED)
  # COLMAP's own build may have found it before us; there must be only one.
  if(NOT TARGET glog::glog)
    find_package(glog CONFIG QUIET)
  endif()
  if(TARGET glog::glog)
    target_link_libraries(ColmapTsar::glog INTERFACE glog::glog)
  else()
    find_package(PkgConfig REQUIRED)
    pkg_check_modules(TSAR_GLOG REQUIRED IMPORTED_TARGET libglog)
    target_link_libraries(ColmapTsar::glog INTERFACE PkgConfig::TSAR_GLOG)
  endif()
endif()

# FLANN's own package file also lists what only its tools need (HDF5, MPI). Its
# headers need LZ4.
if(NOT TARGET ColmapTsar::flann)
  find_path(TSAR_FLANN_INCLUDE_DIR flann/flann.hpp REQUIRED)
  find_library(TSAR_FLANN_LIBRARY flann_cpp REQUIRED)
  find_library(TSAR_LZ4_LIBRARY lz4 REQUIRED)
  mark_as_advanced(
    TSAR_FLANN_INCLUDE_DIR TSAR_FLANN_LIBRARY TSAR_LZ4_LIBRARY)
  add_library(ColmapTsar::flann INTERFACE IMPORTED)
  target_include_directories(ColmapTsar::flann SYSTEM INTERFACE
    ${TSAR_FLANN_INCLUDE_DIR})
  target_link_libraries(ColmapTsar::flann INTERFACE
    ${TSAR_FLANN_LIBRARY} ${TSAR_LZ4_LIBRARY})
endif()
