// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/image.h"

#include <cstdint>
#include <filesystem>

namespace tsar {

// Replaces the file in one step; the name should end in ".png". Throws Error
// kIo.
void WritePng(const ContainedPath& path, const Image<Rgb>& image);

// Reads a picture with one channel of 8 bits. Throws Error kNotFound, and
// kCorrupt for anything else than such a picture.
Image<uint8_t> ReadGrayPng(const std::filesystem::path& path);

}  // namespace tsar
