// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <charconv>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

namespace tsar {

// Parses a text that consists of one number, independently of the locale.
// Returns nullopt for any other text, such as an empty one, one with blanks, a
// plus sign or trailing characters, and for numbers out of the type's range.
template <typename T>
std::optional<T> ParseNumber(std::string_view text) {
  T number{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && rest == end ? std::optional(number)
                                             : std::nullopt;
}

// Reads the next word, between white space, as a number.
template <typename T>
std::optional<T> ReadNumber(std::istream& text) {
  std::string word;
  text >> word;
  return ParseNumber<T>(word);
}

}  // namespace tsar
