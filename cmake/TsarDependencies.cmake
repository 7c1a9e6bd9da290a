find_package(Threads REQUIRED)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(OpenCV REQUIRED COMPONENTS core imgproc imgcodecs)
find_package(Boost REQUIRED COMPONENTS program_options)
find_package(nlohmann_json REQUIRED)

# glog comes without a CMake package on some distributions.
find_package(PkgConfig REQUIRED)
pkg_check_modules(glog REQUIRED IMPORTED_TARGET libglog)

# FLANN's own package file also lists what only its tools need (HDF5, MPI). Its
# headers need LZ4.
find_path(FLANN_INCLUDE_DIR flann/flann.hpp REQUIRED)
find_library(FLANN_LIBRARY flann_cpp REQUIRED)
find_library(LZ4_LIBRARY lz4 REQUIRED)

if(TSAR_TESTS)
  find_package(GTest REQUIRED)
endif()
if(TSAR_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
