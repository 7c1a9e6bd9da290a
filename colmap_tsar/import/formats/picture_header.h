// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace tsar {

// Look at the frame of a picture before a library decodes it, so that a header
// that says more than the file can hold costs no memory. Compressed files tell
// no more than that: a pixel of 16 bits takes at least 1/4096 of its size in
// them. All throw Error kCorrupt, naming the file, and kUnsupported for what
// cannot be depth.

struct PngKind {
  int num_bits = 0;  // Of a channel.
  bool is_gray = false;
};

// Any PNG; also makes sure that the file is whole (see FindPngDefect).
PngKind CheckPngFrame(std::span<const uint8_t> bytes, const std::string& name);

// The same, of 16 bits in grey.
void CheckPng(std::span<const uint8_t> bytes, const std::string& name);

// TIFF, of either byte order; not BigTIFF.
void CheckTiff(std::span<const uint8_t> bytes, const std::string& name);

// OpenEXR.
void CheckExr(std::span<const uint8_t> bytes, const std::string& name);

}  // namespace tsar
