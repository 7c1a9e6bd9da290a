// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/printable.h"

#include <algorithm>

namespace tsar {

std::string_view TakePrintable(std::string_view* text) {
  const auto byte_at = [&](size_t i) {
    return i < text->size() ? static_cast<unsigned char>((*text)[i]) : 0;
  };
  // UTF-8 of the control characters from U+0080 to U+009F.
  const bool is_long_control =
      byte_at(0) == 0xC2 && byte_at(1) >= 0x80 && byte_at(1) < 0xA0;
  const bool is_space = byte_at(0) >= '\t' && byte_at(0) <= '\r';
  const bool is_control =
      is_long_control || byte_at(0) < 0x20 || byte_at(0) == 0x7F;
  const std::string_view taken = text->substr(0, is_long_control ? 2 : 1);
  text->remove_prefix(taken.size());
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
  return Printable(text) != text;
}

std::string ShellWord(const std::string& text) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789%+,-./"
      ":=@_";
  const bool is_plain =
      !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
        return static_cast<unsigned char>(c) >= 0x80 ||
               std::string_view(kPlain).find(c) != std::string_view::npos;
      });
  if (is_plain) {
    return text;
  }
  std::string word = "'";
  for (const char c : text) {
    // A quotation mark ends the quotation and is escaped by a backslash.
    word += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return word + "'";
}

}  // namespace tsar
