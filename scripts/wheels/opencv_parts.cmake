# Included by CMake after project(): OpenCV as a static library names targets of
# these two, which its own package file does not look for.
find_package(OpenEXR 3 CONFIG REQUIRED)
find_package(OpenJPEG CONFIG REQUIRED)
