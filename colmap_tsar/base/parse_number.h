// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <charconv>
#include <istream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>
#include <boost/algorithm/string/trim.hpp>

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

// The shortest text that ParseNumber() reads as this number.
template <typename T>
std::string NumberText(T number) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof(text), number).ptr};
}

// Numbers separated by commas, with blanks around them or not.
template <typename T>
std::optional<std::vector<T>> ParseNumbers(std::string_view text) {
  std::vector<std::string> words;
  boost::split(words, text, boost::is_any_of(","));
  std::vector<T> numbers;
  for (const std::string& word : words) {
    const auto number = ParseNumber<T>(boost::trim_copy(word));
    if (!number) {
      return std::nullopt;
    }
    numbers.push_back(*number);
  }
  return numbers;
}

// Reads the next word, between white space, as a number.
template <typename T>
std::optional<T> ReadNumber(std::istream& text) {
  std::string word;
  text >> word;
  return ParseNumber<T>(word);
}

}  // namespace tsar
