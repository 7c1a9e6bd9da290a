// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/formats/pfm.h"

#include <bit>
#include <charconv>
#include <cstring>

namespace tsar {
namespace {

bool IsSpace(uint8_t c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// The next word; takes one byte of white space after it.
std::string ReadWord(ByteReader* reader) {
  constexpr size_t kMaxLength = 40;
  std::string word;
  for (;;) {
    const auto c = reader->Read<uint8_t>();
    if (!IsSpace(c)) {
      word.push_back(static_cast<char>(c));
    } else if (!word.empty()) {
      return word;
    }
    if (word.size() > kMaxLength) {
      throw reader->Corrupt("not a PFM file");
    }
  }
}

template <typename T>
T ReadNumber(ByteReader* reader) {
  const std::string word = ReadWord(reader);
  T number = 0;
  const auto [end, error] =
      std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) {
    throw reader->Corrupt("the PFM header has no number where one is due");
  }
  return number;
}

}  // namespace

FloatMap ParsePfm(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader reader(bytes, name);
  const std::string kind = ReadWord(&reader);
  if (kind != "Pf" && kind != "PF") {
    throw reader.Corrupt("not a PFM file");
  }
  FloatMap map;
  map.channels = kind == "Pf" ? 1 : 3;
  map.width = ReadNumber<int>(&reader);
  map.height = ReadNumber<int>(&reader);
  const double scale = ReadNumber<double>(&reader);
  if (!(scale < 0.0) && !(scale > 0.0)) {
    throw reader.Corrupt("the scale of the PFM header is 0 or no number");
  }
  map.values.resize(RequireExactLength(
      reader, map.width, map.height, map.channels, sizeof(float)));
  const size_t row = static_cast<size_t>(map.width * map.channels);
  for (int y = map.height - 1; y >= 0; --y) {
    reader.ReadAll<float>(
        {map.values.data() + static_cast<size_t>(y) * row, row});
  }
  if (scale > 0.0) {
    for (float& value : map.values) {
      value = std::bit_cast<float>(
          __builtin_bswap32(std::bit_cast<uint32_t>(value)));
    }
  }
  return map;
}

}  // namespace tsar
