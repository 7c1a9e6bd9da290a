// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <sstream>

namespace tsar {

// A string stream that throws std::bad_alloc if memory runs out; a standard
// stream silently drops parts of the text then.
class TextStream : public std::ostringstream {
 public:
  TextStream() { exceptions(std::ios::badbit); }
};

}  // namespace tsar
