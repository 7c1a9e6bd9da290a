// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// Checks the header of an OpenEXR file before OpenCV decodes it, so that a
// declared size beyond what the file can hold allocates no memory: a pixel
// takes at least 1/2048 byte. Throws Error kCorrupt with the file.
void CheckExr(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace tsar
