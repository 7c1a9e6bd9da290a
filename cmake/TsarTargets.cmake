# Targets and the functions by which the folders add to them.

add_library(colmap_tsar STATIC)
add_library(ColmapTsar::colmap_tsar ALIAS colmap_tsar)
target_include_directories(colmap_tsar PUBLIC
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
# As system headers, so that their warnings are not ours. No installed header
# includes them.
target_include_directories(colmap_tsar SYSTEM PUBLIC
  "$<BUILD_INTERFACE:${OpenCV_INCLUDE_DIRS}>")
target_compile_features(colmap_tsar PUBLIC cxx_std_20)
# The Python module is a shared library and holds this one.
if(TSAR_PYTHON)
  set_target_properties(colmap_tsar PROPERTIES POSITION_INDEPENDENT_CODE ON)
endif()
target_compile_definitions(colmap_tsar PRIVATE
  TSAR_VERSION="${PROJECT_VERSION}")
target_link_libraries(colmap_tsar
  PUBLIC Eigen3::Eigen
  PRIVATE Threads::Threads opencv_core opencv_imgproc opencv_imgcodecs
          $<BUILD_INTERFACE:Boost::headers> $<LINK_ONLY:Boost::program_options> Ceres::ceres ColmapTsar::glog
          ColmapTsar::xxhash
          $<$<BOOL:${TSAR_CLOUD_EVALUATION}>:ColmapTsar::lz4>
          $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>
          $<$<BOOL:${TSAR_CUDA_ENABLED}>:CUDA::cudart_static>)

# What a program needs that takes over the commands: it may be compiled for an
# older C++ than the library is.
add_library(tsar_commands INTERFACE)
add_library(ColmapTsar::commands ALIAS tsar_commands)
set_target_properties(tsar_commands PROPERTIES EXPORT_NAME commands)
target_include_directories(tsar_commands INTERFACE
  $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
  $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_libraries(tsar_commands INTERFACE $<LINK_ONLY:colmap_tsar>)

# Warnings, sanitizers and the rules of floating-point arithmetic, for every
# target of this project.
function(tsar_configure_target target)
  set(warnings -Wall -Wextra)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
    # GCC 12 sees overlaps and overruns inside std::string where none are.
    list(APPEND warnings -Wno-array-bounds -Wno-restrict
      -Wno-stringop-overflow -Wno-stringop-overread)
  endif()
  if(TSAR_WARNINGS_AS_ERRORS)
    list(APPEND warnings -Werror)
  endif()
  # Contraction is off because a fused multiply-add rounds differently: the
  # same source must give the same bytes with every host compiler and on the
  # GPU. nvcc rounds divisions and roots correctly unless told otherwise.
  set(host_flags ${warnings} -ffp-contract=off)
  if(TSAR_SANITIZE)
    list(APPEND host_flags -fsanitize=address,undefined
      -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=address,undefined)
    # Under the address sanitizer Eigen would pad what it allocates; Ceres,
    # which was built without, frees the same blocks as they are.
    target_compile_definitions(${target} PRIVATE EIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
  list(JOIN host_flags "," cuda_host_flags)
  target_compile_options(${target} PRIVATE
    "$<$<COMPILE_LANGUAGE:CXX>:${host_flags}>"
    "$<$<COMPILE_LANGUAGE:CUDA>:SHELL:-fmad=false -Xcompiler ${cuda_host_flags}>")
  # Kernels do not use Eigen; its device code is full of warnings.
  target_compile_definitions(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CUDA>:EIGEN_NO_CUDA>)
  if(TSAR_CUDA_ENABLED AND TSAR_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE
      "$<$<COMPILE_LANGUAGE:CUDA>:SHELL:--Werror all-warnings>")
  endif()
endfunction()

# Headers that most files include, parsed once for all of a target's files:
# without that, they take nine tenths of the time to compile a typical file.
function(tsar_precompile_headers target)
  set(headers ${ARGN})
  list(TRANSFORM headers REPLACE "(.+)" "$<$<COMPILE_LANGUAGE:CXX>:<\\1$<ANGLE-R>>")
  target_precompile_headers(${target} PRIVATE ${headers})
endfunction()

# Adds a folder's files to the library. A .cu file holds both forms of its
# loops; without CUDA it is compiled as C++.
function(tsar_add_sources)
  foreach(file IN LISTS ARGN)
    set(path ${CMAKE_CURRENT_SOURCE_DIR}/${file})
    target_sources(colmap_tsar PRIVATE ${path})
    if(file MATCHES "\\.cu$" AND NOT TSAR_CUDA_ENABLED)
      set_source_files_properties(${path}
        TARGET_DIRECTORY colmap_tsar PROPERTIES LANGUAGE CXX)
    endif()
  endforeach()
endfunction()

tsar_configure_target(colmap_tsar)
# glog tells its macros' files at run time: without the folder they were built
# in.
target_compile_options(colmap_tsar PRIVATE
  "$<$<COMPILE_LANGUAGE:CXX>:-fmacro-prefix-map=${PROJECT_SOURCE_DIR}/=>")
tsar_precompile_headers(colmap_tsar
  algorithm cmath cstdint filesystem functional map memory optional string
  system_error vector Eigen/Core Eigen/Geometry Eigen/LU)
