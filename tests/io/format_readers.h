// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/float_map.h"

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/external_writers.h"
#include <opencv2/core.hpp>

namespace tsar {

// The values of the maps of 3 x 2 pixels in the tests of the readers.
inline const std::vector<float> kSix = {1, 2, 3, 4, 5, 6};

std::string Int32s(const std::vector<int32_t>& numbers);

// Depths kSix with their camera and normals.
DmapContent SmallDmap();

// Without loss, in the format of a file name's extension.
std::string EncodedPicture(const std::string& extension, const cv::Mat& mat);

// Each reader by its format: the size and the values of what comes out.
FloatMap ReadDmb(const std::string& bytes);
FloatMap ReadApd(const std::string& bytes);
FloatMap ReadPfm(const std::string& bytes);
FloatMap ReadNpy(const std::string& bytes);
FloatMap ReadDmap(const std::string& bytes);
FloatMap ReadPng(const std::string& bytes);
FloatMap ReadTiff(const std::string& bytes);

}  // namespace tsar
