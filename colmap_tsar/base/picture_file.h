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

// Writes pixels (of colors BGR) into a file in a picture format that OpenCV
// has: ".png", ".jpg". parameters: as cv::imencode() has them. Throws kIo,
// which names the path, where OpenCV was built without the format, and
// std::bad_alloc.
void PutPicture(const cv::Mat& pixels,
                const std::string& extension,
                const std::filesystem::path& path,
                AtomicFile* file,
                const std::vector<int>& parameters = {});

// The pixels of a file, as cv::imdecode() has them in this mode; empty where
// OpenCV cannot decode it. Throws std::bad_alloc.
cv::Mat DecodePicture(std::span<const uint8_t> bytes, int mode);

}  // namespace tsar
