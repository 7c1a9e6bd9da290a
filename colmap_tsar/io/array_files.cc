// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/array_files.h"

#include "colmap_tsar/base/arithmetic.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <string_view>

namespace tsar {
namespace {

bool IsSpace(uint8_t c) {
  return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

// Reads the next word and one byte of white space after it.
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

Error Unsupported(const std::string& name,
                  const std::string& what,
                  const std::string& advice) {
  return Error::File(ErrorCode::kUnsupported, name, what, advice);
}

// Returns the text after a key of the header, a Python dictionary, from the
// first character of its value.
std::string_view ValueOf(std::string_view header,
                         const std::string& key,
                         const ByteReader& reader) {
  const std::string quoted = "'" + key + "'";
  size_t position = header.find(quoted);
  if (position != std::string_view::npos) {
    position = header.find_first_not_of(" :", position + quoted.size());
  }
  if (position == std::string_view::npos) {
    throw reader.Corrupt("the NumPy header has no " + key);
  }
  return header.substr(position);
}

// Reads the type, such as "<f4" from "'<f4', ...".
std::string ReadType(std::string_view header, const ByteReader& reader) {
  const std::string_view value = ValueOf(header, "descr", reader);
  const size_t end = value.find('\'', 1);
  if (value[0] != '\'' || end == std::string_view::npos) {
    return "";
  }
  return std::string(value.substr(1, end - 1));
}

// Reads the shape from "(480, 640), ...".
std::vector<int64_t> ReadShape(std::string_view header,
                               const ByteReader& reader) {
  const std::string_view value = ValueOf(header, "shape", reader);
  const size_t close = value.find(')');
  if (value[0] != '(' || close == std::string_view::npos) {
    throw reader.Corrupt("the NumPy header has no shape");
  }
  std::vector<int64_t> shape;
  const char* next = value.data() + 1;
  const char* const end = value.data() + close;
  while (next < end) {
    int64_t number = 0;
    const auto [after, error] = std::from_chars(next, end, number);
    if (error != std::errc()) {
      throw reader.Corrupt("the NumPy header has a shape that is none");
    }
    shape.push_back(number);
    next = std::find_if_not(
        after, end, [](char c) { return c == ',' || c == ' ' || c == 'L'; });
  }
  return shape;
}

template <typename T, typename Convert>
void ReadValues(bool swap,
                Convert convert,
                ByteReader* reader,
                std::vector<float>* values) {
  for (float& value : *values) {
    T stored = reader->Read<T>();
    if (swap) {
      auto* first = reinterpret_cast<uint8_t*>(&stored);
      std::reverse(first, first + sizeof(T));
    }
    value = convert(stored);
  }
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

NpyArray ParseNpy(std::span<const uint8_t> bytes, const std::string& name) {
  constexpr std::string_view kMagic = "\x93NUMPY";
  ByteReader reader(bytes, name);
  const std::span<const uint8_t> magic = reader.Take(kMagic.size());
  const auto major = reader.Read<uint8_t>();
  reader.Read<uint8_t>();
  if (std::memcmp(magic.data(), kMagic.data(), kMagic.size()) != 0 ||
      major < 1 || major > 3) {
    throw reader.Corrupt("not a NumPy array of version 1 to 3");
  }
  const size_t length =
      major == 1 ? reader.Read<uint16_t>() : reader.Read<uint32_t>();
  const std::span<const uint8_t> text = reader.Take(length);
  const std::string header(text.begin(), text.end());

  const std::string type = ReadType(header, reader);
  const std::string kind = type.empty() ? "" : type.substr(1);
  const bool is_known =
      (type[0] == '<' || type[0] == '>') &&
      (kind == "f2" || kind == "f4" || kind == "f8" || kind == "u2");
  if (!is_known) {
    throw Unsupported(name,
                      "its values are of the type '" + type + "'",
                      "save float16, float32, float64 or uint16");
  }
  if (!ValueOf(header, "fortran_order", reader).starts_with("False")) {
    throw Unsupported(name,
                      "its columns are stored one after the other",
                      "save numpy.ascontiguousarray of it");
  }
  const std::vector<int64_t> shape = ReadShape(header, reader);
  if (shape.size() != 2 && shape.size() != 3) {
    throw Unsupported(name,
                      "it has " + std::to_string(shape.size()) + " dimensions",
                      "save an array of shape (height, width)");
  }
  const size_t num_value_bytes = static_cast<size_t>(kind[1] - '0');
  const int64_t channels = shape.size() == 3 ? shape[2] : 1;
  NpyArray array;
  array.map.values.resize(RequireExactLength(
      reader, shape[1], shape[0], channels, num_value_bytes));
  array.map.width = static_cast<int>(shape[1]);
  array.map.height = static_cast<int>(shape[0]);
  array.map.channels = static_cast<int>(channels);
  array.is_integer = kind == "u2";
  const bool swap = type[0] == '>';
  const auto to_float = [](auto value) { return static_cast<float>(value); };
  if (kind == "f2") {
    ReadValues<uint16_t>(swap, &HalfToFloat, &reader, &array.map.values);
  } else if (kind == "u2") {
    ReadValues<uint16_t>(swap, to_float, &reader, &array.map.values);
  } else if (kind == "f4") {
    ReadValues<float>(swap, to_float, &reader, &array.map.values);
  } else {
    ReadValues<double>(swap, to_float, &reader, &array.map.values);
  }
  return array;
}

}  // namespace tsar
