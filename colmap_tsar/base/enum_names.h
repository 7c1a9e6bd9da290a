// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace tsar {

// The values of an enum with their names in options and files.
template <typename Enum, size_t kNumValues>
using EnumNames = std::array<std::pair<Enum, const char*>, kNumValues>;

// Throws std::invalid_argument for a value that has no name.
template <typename Enum, size_t kNumValues>
std::string EnumName(const EnumNames<Enum, kNumValues>& names, Enum value) {
  for (const auto& [named, name] : names) {
    if (named == value) {
      return name;
    }
  }
  throw std::invalid_argument("a value of an enum without a name");
}

// Returns nullopt for a text that is no name.
template <typename Enum, size_t kNumValues>
std::optional<Enum> FindEnumValue(const EnumNames<Enum, kNumValues>& names,
                                  std::string_view text) {
  for (const auto& [value, name] : names) {
    if (text == name) {
      return value;
    }
  }
  return std::nullopt;
}

}  // namespace tsar
