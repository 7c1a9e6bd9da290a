// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdarg>
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

// What std::printf() would print, at most 255 characters; compilers compare the
// format with the values.
__attribute__((format(printf, 1, 2))) inline std::string Formatted(
    const char* format, ...) {
  char text[256];
  std::va_list values;
  va_start(values, format);
  std::vsnprintf(text, sizeof(text), format, values);
  va_end(values);
  return text;
}

}  // namespace tsar
