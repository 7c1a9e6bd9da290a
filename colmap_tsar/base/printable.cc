// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/printable.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tsar {
namespace {

struct Character {
  uint32_t code = 0;
  size_t num_bytes = 0;  // 0 if the text does not begin with UTF-8.
};

// The first character of a nonempty text. As in Unicode, overlong forms and
// surrogates are invalid.
Character FirstOf(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  if (first < 0x80) {
    return {first, 1};
  }
  const size_t num_bytes = first < 0xC2   ? 0
                           : first < 0xE0 ? 2
                           : first < 0xF0 ? 3
                           : first < 0xF5 ? 4
                                          : 0;
  if (num_bytes == 0 || text.size() < num_bytes) {
    return {};
  }
  uint32_t code = first & (0xFFu >> (num_bytes + 1));
  for (size_t i = 1; i < num_bytes; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xC0) != 0x80) {
      return {};
    }
    code = (code << 6) | (next & 0x3Fu);
  }
  const bool is_surrogate = code >= 0xD800 && code <= 0xDFFF;
  const bool is_too_long =
      (num_bytes == 3 && code < 0x800) || (num_bytes == 4 && code < 0x10000);
  if (is_surrogate || is_too_long || code > 0x10FFFF) {
    return {};
  }
  return {code, num_bytes};
}

bool IsControl(uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0);
}

// Whether a character is white space, including line ends.
bool IsControlledSpace(uint32_t code) {
  constexpr uint32_t kNextLine = 0x85;
  constexpr uint32_t kLineSeparator = 0x2028;
  constexpr uint32_t kParagraphSeparator = 0x2029;
  return (code >= '\t' && code <= '\r') || code == kNextLine ||
         code == kLineSeparator || code == kParagraphSeparator;
}

// Whether a character is a bidirectional control (embedding, override or
// isolate), which changes the displayed order of text.
bool TurnsDirection(uint32_t code) {
  return (code >= 0x202A && code <= 0x202E) ||
         (code >= 0x2066 && code <= 0x2069);
}

}  // namespace

std::string_view TakePrintable(std::string_view* text) {
  const Character character = FirstOf(*text);
  const std::string_view taken =
      text->substr(0, std::max<size_t>(character.num_bytes, 1));
  text->remove_prefix(taken.size());
  if (character.num_bytes > 0 && IsControlledSpace(character.code)) {
    return " ";
  }
  const bool is_obeyed = character.num_bytes == 0 ||
                         IsControl(character.code) ||
                         TurnsDirection(character.code);
  return is_obeyed ? "?" : taken;
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
    const Character character = FirstOf(text);
    if (character.num_bytes > 0 && IsControl(character.code)) {
      return true;
    }
    text.remove_prefix(std::max<size_t>(character.num_bytes, 1));
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
