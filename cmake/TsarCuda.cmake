# Decides whether the .cu files are compiled by nvcc or, as plain C++, by the
# host compiler. Sets TSAR_CUDA_ENABLED.

set(TSAR_CUDA_ENABLED OFF)
# Where another project adds this one, AUTO follows it: a language that is
# enabled in a subfolder alone is not known to the rest.
get_property(tsar_languages GLOBAL PROPERTY ENABLED_LANGUAGES)
if(TSAR_CUDA STREQUAL "ON" OR
   (TSAR_CUDA STREQUAL "AUTO" AND
    (PROJECT_IS_TOP_LEVEL OR "CUDA" IN_LIST tsar_languages)))
  include(CheckLanguage)
  check_language(CUDA)
  if(CMAKE_CUDA_COMPILER)
    # Every major architecture from Turing on, and PTX of the last one for
    # cards that come later. nvcc 13 knows 7.5 to 12.0.
    if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
      set(CMAKE_CUDA_ARCHITECTURES all-major)
    endif()
    enable_language(CUDA)
    if(CMAKE_CUDA_COMPILER_ID STREQUAL "NVIDIA" AND
       CMAKE_CUDA_COMPILER_VERSION VERSION_LESS 12)
      set(tsar_old_nvcc
        "nvcc ${CMAKE_CUDA_COMPILER_VERSION} has no C++20, which CUDA 12 has")
      if(TSAR_CUDA STREQUAL "ON")
        message(FATAL_ERROR "TSAR_CUDA=ON, but ${tsar_old_nvcc}; set "
          "CMAKE_CUDA_COMPILER to a newer one, or TSAR_CUDA=OFF")
      endif()
      message(STATUS "${tsar_old_nvcc}: built for the CPU alone")
    else()
      # CMake 3.25 does not know that nvcc has C++20 since 12.0.
      if(NOT DEFINED CMAKE_CUDA20_STANDARD_COMPILE_OPTION)
        set(CMAKE_CUDA20_STANDARD_COMPILE_OPTION "-std=c++20")
        set(CMAKE_CUDA20_EXTENSION_COMPILE_OPTION "-std=c++20")
      endif()
      set(CMAKE_CUDA_STANDARD 20)
      set(CMAKE_CUDA_STANDARD_REQUIRED ON)
      set(TSAR_CUDA_ENABLED ON)
    endif()
  elseif(TSAR_CUDA STREQUAL "ON")
    message(FATAL_ERROR
      "TSAR_CUDA=ON, but no CUDA compiler was found; put nvcc on the PATH or "
      "set CMAKE_CUDA_COMPILER")
  endif()
endif()
message(STATUS "CUDA: ${TSAR_CUDA_ENABLED}")
