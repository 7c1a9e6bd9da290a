# Targets of the libraries that come without a CMake package on some
# distributions. Part of the installed package too, which must not end the
# projects that only ask for it: sets tsar_missing to what was not found, or to
# nothing.
set(tsar_missing "")

if(NOT TARGET ColmapTsar::glog)
  # COLMAP's own build may have found it before us; there must be only one.
  if(NOT TARGET glog::glog)
    find_package(glog CONFIG QUIET)
  endif()
  set(tsar_glog glog::glog)
  if(NOT TARGET glog::glog)
    set(tsar_glog PkgConfig::TSAR_GLOG)
    find_package(PkgConfig QUIET)
    if(PkgConfig_FOUND)
      pkg_check_modules(TSAR_GLOG QUIET IMPORTED_TARGET libglog)
    endif()
  endif()
  if(TARGET ${tsar_glog})
    add_library(ColmapTsar::glog INTERFACE IMPORTED)
    target_link_libraries(ColmapTsar::glog INTERFACE ${tsar_glog})
  else()
    list(APPEND tsar_missing "glog")
  endif()
endif()

# For the scores of point clouds.
if(TSAR_CLOUD_EVALUATION AND NOT TARGET ColmapTsar::lz4)
  find_library(TSAR_LZ4_LIBRARY lz4)
  mark_as_advanced(TSAR_LZ4_LIBRARY)
  if(NOT TSAR_LZ4_LIBRARY)
    list(APPEND tsar_missing "LZ4")
  else()
    add_library(ColmapTsar::lz4 INTERFACE IMPORTED)
    target_link_libraries(ColmapTsar::lz4 INTERFACE ${TSAR_LZ4_LIBRARY})
  endif()
endif()

# Neither Debian 12 nor Ubuntu 24.04 packs xxHash's CMake package.
if(NOT TARGET ColmapTsar::xxhash)
  find_path(TSAR_XXHASH_INCLUDE_DIR xxhash.h)
  find_library(TSAR_XXHASH_LIBRARY xxhash)
  mark_as_advanced(TSAR_XXHASH_INCLUDE_DIR TSAR_XXHASH_LIBRARY)
  if(NOT TSAR_XXHASH_INCLUDE_DIR OR NOT TSAR_XXHASH_LIBRARY)
    list(APPEND tsar_missing "xxHash (xxhash.h, xxhash)")
  else()
    add_library(ColmapTsar::xxhash INTERFACE IMPORTED)
    target_include_directories(ColmapTsar::xxhash SYSTEM INTERFACE
      ${TSAR_XXHASH_INCLUDE_DIR})
    target_link_libraries(ColmapTsar::xxhash INTERFACE ${TSAR_XXHASH_LIBRARY})
  endif()
endif()
list(JOIN tsar_missing ", " tsar_missing)
