# Copyright (c) 2026, the TSAR for COLMAP authors.
# SPDX-License-Identifier: BSD-3-Clause
#
# To be sourced: builds the libraries that go into wheels, each as a static one
# of the parts that are used, from the distribution's source packages. The
# caller sets
#
#   work      where sources, builds and results go
#   sources   a folder with a folder for each source package that is not to be
#             taken from the distribution; or nothing
#
# and defines fail MESSAGE, which ends the script.

# The results, in which CMake finds them.
libraries=$work/libraries

# fetch_library PACKAGE: sets source.
fetch_library() {
  local version versions
  if [[ -n $sources && -d $sources/$1 ]]; then
    source=$sources/$1
    return
  fi
  source=$work/sources/$1
  if [[ -d $source ]]; then
    return
  fi
  if [[ -z ${lists_are_read:-} ]]; then
    read_apt_sources ||
      fail "apt knows no suite of Debian or Ubuntu; run apt-get update"
    lists_are_read=1
  fi
  versions=$(source_versions "$1" | tac)
  for version in $versions; do
    if unpack_source "$1" "$version" "$source"; then
      return
    fi
    echo "build_wheels: $1 $version cannot be had, see above" >&2
  done
  fail "no source package $1 can be had; get its source and name the folder \
that holds it as a folder $1 by --sources"
}

# build_library PACKAGE FOLDER CMAKE_OPTION...: FOLDER of the source package.
# Nothing is done where it has been built with the same options.
build_library() {
  local package=$1 folder=$2 source digest log=$work/logs/$1.log
  local build=$work/libraries-build/$1
  local options
  shift 2
  fetch_library "$package"
  # With its type: CMake takes an untyped value for a path of this folder.
  options=("${launchers[@]}" -DCMAKE_BUILD_TYPE=Release
           -DCMAKE_INSTALL_PREFIX="$libraries"
           -DCMAKE_INSTALL_LIBDIR:STRING=lib -DCMAKE_PREFIX_PATH="$libraries"
           -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_SHARED_LIBS=OFF
           -DBUILD_TESTING=OFF "$@")
  digest=$(printf '%s\n' "$source" "${options[@]}" | sha256sum)
  if [[ $(cat "$build/installed" 2>/dev/null) == "$digest" ]]; then
    return
  fi
  echo "$package"
  mkdir -p "$work/logs"
  rm -f "$build/installed"
  if ! { cmake -G Ninja -S "$source/$folder" -B "$build" "${options[@]}" &&
         cmake --build "$build" &&
         cmake --install "$build"; } >"$log" 2>&1; then
    tail -20 "$log" >&2
    fail "$package could not be built; $log has the rest"
  fi
  # Some come as shared ones too, which a linker would prefer.
  find "$libraries/lib" -name '*.so*' -delete
  echo "$digest" >"$build/installed"
}

# Those that read and write pictures, with the formats of photos that the
# program takes. They use the system's zlib, which every Linux with Python has.
build_picture_libraries() {
  build_library libpng1.6 . -DPNG_SHARED=OFF -DPNG_TESTS=OFF \
    -DPNG_EXECUTABLES=OFF
  build_library libjpeg-turbo . -DENABLE_SHARED=OFF -DWITH_TURBOJPEG=OFF \
    -DREQUIRE_SIMD=ON
  build_library tiff . -Dcxx=OFF -Djbig=OFF -Dlerc=OFF -Dlibdeflate=OFF \
    -Dlzma=OFF -Dtiff-contrib=OFF -Dtiff-docs=OFF -Dtiff-tests=OFF \
    -Dtiff-tools=OFF -Dwebp=OFF -Dzstd=OFF
  build_library libwebp . -DWEBP_BUILD_ANIM_UTILS=OFF -DWEBP_BUILD_CWEBP=OFF \
    -DWEBP_BUILD_DWEBP=OFF -DWEBP_BUILD_EXTRAS=OFF -DWEBP_BUILD_GIF2WEBP=OFF \
    -DWEBP_BUILD_IMG2WEBP=OFF -DWEBP_BUILD_VWEBP=OFF -DWEBP_BUILD_WEBPINFO=OFF \
    -DWEBP_BUILD_WEBPMUX=OFF
  build_library openjpeg2 . -DBUILD_CODEC=OFF
  build_library imath .
  build_library openexr . -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_TOOLS=OFF \
    -DOPENEXR_INSTALL_EXAMPLES=OFF
}

# Ceres with Eigen for sparse matrices, which is what is used here, and without
# SuiteSparse and LAPACK.
build_ceres() {
  build_library google-glog . -DWITH_GFLAGS=OFF -DWITH_GTEST=OFF \
    -DWITH_UNWIND=OFF
  build_library ceres-solver . -DBUILD_BENCHMARKS=OFF -DBUILD_EXAMPLES=OFF \
    -DCUDA=OFF -DUSE_CUDA=OFF -DCXSPARSE=OFF -DEIGENSPARSE=ON -DGFLAGS=OFF \
    -DLAPACK=OFF -DPROVIDE_UNINSTALL_TARGET=OFF -DSCHUR_SPECIALIZATIONS=OFF \
    -DSUITESPARSE=OFF
}

# Three modules of OpenCV. What it looks for by itself is what the other modules
# would use.
build_opencv() {
  local name options=()
  for name in 1394 ADE EIGEN FFMPEG GDAL GDCM GPHOTO2 GSTREAMER GTK IPP ITT \
      JASPER LAPACK OPENCL OPENGL PROTOBUF QT QUIRC TBB V4L VA VTK; do
    options+=("-DWITH_$name=OFF")
  done
  for name in DOCS EXAMPLES JAVA PERF_TESTS TESTS opencv_apps opencv_python3; do
    options+=("-DBUILD_$name=OFF")
  done
  for name in JPEG OPENEXR OPENJPEG PNG TIFF WEBP ZLIB; do
    options+=("-DBUILD_$name=OFF")
  done
  build_library opencv . -DBUILD_LIST=core,imgproc,imgcodecs "${options[@]}" \
    -DENABLE_PRECOMPILED_HEADERS=OFF
}

build_libraries() {
  launchers=()
  if command -v ccache >/dev/null; then
    launchers=(-DCMAKE_C_COMPILER_LAUNCHER=ccache
               -DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
  fi
  build_picture_libraries
  build_opencv
  build_ceres
  build_library lz4 build/cmake -DLZ4_BUILD_CLI=OFF -DLZ4_BUILD_LEGACY_LZ4C=OFF
  build_library xxhash cmake_unofficial -DXXHASH_BUILD_XXHSUM=OFF
}

# copy_licenses FOLDER: of all that is inside of a wheel, a file for each, as the
# distribution has them.
copy_licenses() {
  local folder file package
  mkdir -p "$1"
  for folder in "$work/sources"/*/ ${sources:+"$sources"/*/}; do
    # A folder that the user names may be the library's own release.
    for file in debian/copyright LICENSE LICENSE.md LICENSE.txt LICENCE COPYING; do
      if [[ -f $folder$file ]]; then
        cp "$folder$file" "$1/$(basename "$folder")"
        break
      fi
    done
  done
  for package in libboost-dev libeigen3-dev libflann-dev \
      nlohmann-json3-dev; do
    if [[ -f /usr/share/doc/$package/copyright ]]; then
      cp "/usr/share/doc/$package/copyright" "$1/$package"
    fi
  done
}
