// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdio>
#include <sstream>
#include <string>

namespace tsar {

// A string stream that throws std::bad_alloc if memory runs out; a standard
// stream silently drops parts of the text then.
class TextStream : public std::ostringstream {
 public:
  TextStream() { exceptions(std::ios::badbit); }
};

// What std::printf() would print, at most 255 characters.
template <typename... Values>
std::string Formatted(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

}  // namespace tsar
