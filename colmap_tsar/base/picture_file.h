// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/atomic_file.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace cv {
class Mat;
}

namespace tsar {

// Writes pixels (colors as BGR) to a file in a format of OpenCV: ".png",
// ".jpg". parameters: those of cv::imencode(). Throws kIo with the path if
// OpenCV was built without the format, and std::bad_alloc.
void PutPicture(const cv::Mat& pixels,
                const std::string& extension,
                const std::filesystem::path& path,
                AtomicFile* file,
                const std::vector<int>& parameters = {});

// The pixels of a file as cv::imdecode() returns them in this mode; empty if
// OpenCV cannot decode it, or it has 2 GB or more. Throws std::bad_alloc.
cv::Mat DecodePicture(std::span<const uint8_t> bytes, int mode);

}  // namespace tsar
