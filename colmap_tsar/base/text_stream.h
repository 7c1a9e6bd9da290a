// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <sstream>

namespace tsar {

// Composes text. Throws std::bad_alloc where memory runs out; a stream of the
// standard library leaves parts of the text out then, and only those who ask
// are told.
class TextStream : public std::ostringstream {
 public:
  TextStream() { exceptions(std::ios::badbit); }
};

}  // namespace tsar
