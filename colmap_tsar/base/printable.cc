// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/printable.h"

namespace tsar {

std::string_view TakePrintable(std::string_view* text) {
  const auto byte_at = [&](size_t i) {
    return i < text->size() ? static_cast<unsigned char>((*text)[i]) : 0;
  };
  const auto lead = byte_at(0);
  size_t length = lead < 0xC2 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
  for (size_t i = 1; i < length; ++i) {
    length = byte_at(i) >= 0x80 && byte_at(i) < 0xC0 ? length : 1;
  }
  const bool is_space = lead >= '\t' && lead <= '\r';
  // Some terminals obey control characters from U+0080 to U+009F, and bytes of
  // these values. Other bytes that are not UTF-8 are replaced as well.
  const bool is_control = lead < 0x20 || lead == 0x7F ||
                          (lead >= 0x80 && length == 1) ||
                          (lead == 0xC2 && byte_at(1) < 0xA0);
  const std::string_view taken = text->substr(0, length);
  text->remove_prefix(length);
  return is_space ? " " : is_control ? "?" : taken;
}

std::string Printable(std::string_view text) {
  std::string printable;
  printable.reserve(text.size());
  while (!text.empty()) {
    printable += TakePrintable(&text);
  }
  return printable;
}

bool HasControlCharacter(std::string_view text) {
  for (size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next =
        static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    if (byte < 0x20 || byte == 0x7F ||
        (byte == 0xC2 && next >= 0x80 && next < 0xA0)) {
      return true;
    }
  }
  return false;
}

}  // namespace tsar
