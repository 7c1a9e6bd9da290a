// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <filesystem>

namespace tsar {

// These functions read a picture of one channel of 8 or 16 bits: the
// confidence, provenance and plane maps of a refined workspace. They throw
// Error kNotFound, and kCorrupt for anything but such a picture.
Image<uint8_t> ReadGrayPng(const std::filesystem::path& path);
Image<uint16_t> ReadGray16Png(const std::filesystem::path& path);

}  // namespace tsar
