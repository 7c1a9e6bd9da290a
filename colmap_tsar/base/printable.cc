// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/printable.h"

#include <algorithm>

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
  while (!text.empty()) {
    // A lone byte is a letter of another encoding than UTF-8.
    const std::string_view before = text;
    const bool is_replaced = TakePrintable(&text).data() != before.data();
    const bool is_lone = static_cast<unsigned char>(before[0]) >= 0x80 &&
                         before.size() - text.size() == 1;
    if (is_replaced && !is_lone) {
      return true;
    }
  }
  return false;
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
