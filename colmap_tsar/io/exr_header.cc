// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/exr_header.h"

#include "colmap_tsar/io/float_map.h"

#include <array>
#include <string_view>
#include <utility>

namespace tsar {
namespace {

void RequirePossibleSize(const ByteReader& reader,
                         int64_t width,
                         int64_t height,
                         size_t num_file_bytes) {
  constexpr int64_t kMaxSide = int64_t{1} << 24;
  constexpr uint64_t kMaxRatio = 4096;
  constexpr uint64_t kMinPixelBytes = 2;
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide ||
      kMinPixelBytes * static_cast<uint64_t>(width * height) / kMaxRatio >
          num_file_bytes) {
    throw reader.Corrupt("the header says " + std::to_string(width) + " x " +
                         std::to_string(height) +
                         " pixels, which the file cannot hold");
  }
}

// Reads a null-terminated text.
std::string ReadText(ByteReader* reader) {
  std::string text;
  for (char c = reader->Read<char>(); c != '\0'; c = reader->Read<char>()) {
    text.push_back(c);
  }
  return text;
}

// The types of EXR attributes of fixed size, with their bytes.
constexpr std::pair<std::string_view, size_t> kExrSizes[] = {
    {"box2i", 16},   {"box2f", 16},    {"chromaticities", 32},
    {"double", 8},   {"envmap", 1},    {"compression", 1},
    {"float", 4},    {"int", 4},       {"deepImageState", 1},
    {"keycode", 28}, {"lineOrder", 1}, {"m33f", 36},
    {"m33d", 72},    {"m44f", 64},     {"m44d", 128},
    {"rational", 8}, {"tiledesc", 9},  {"timecode", 8},
    {"v2i", 8},      {"v2f", 8},       {"v2d", 16},
    {"v3i", 12},     {"v3f", 12},      {"v3d", 24}};

// Reads an attribute's value as OpenEXR does, which allocates memory by the
// counts in it and reads the size of its type whatever the header says: after a
// different size it would find other attributes than CheckExr. The rest is left
// in the reader.
void TakeExrValue(const std::string& type, ByteReader* reader) {
  for (const auto& [known, size] : kExrSizes) {
    if (type == known) {
      reader->Take(size);
      return;
    }
  }
  if (type == "chlist") {
    constexpr size_t kChannelSize = 16;
    while (!ReadText(reader).empty()) {
      reader->Take(kChannelSize);
    }
  } else if (type == "preview") {
    const uint64_t width = reader->Read<uint32_t>();
    const uint64_t height = reader->Read<uint32_t>();
    constexpr uint64_t kMaxSide = 1 << 16;
    if (width > kMaxSide || height > kMaxSide) {
      throw reader->Corrupt("the EXR header has a preview of another size");
    }
    reader->Take(width * height * sizeof(uint32_t));
  } else if (type == "stringvector") {
    while (reader->NumLeft() > 0) {
      reader->Take(reader->Read<uint32_t>());
    }
  } else if (type == "floatvector") {
    reader->Take(reader->NumLeft() / sizeof(float) * sizeof(float));
  } else {
    reader->Take(reader->NumLeft());
  }
}

}  // namespace

void CheckExr(std::span<const uint8_t> bytes, const std::string& name) {
  constexpr uint32_t kMagic = 20000630;
  ByteReader reader(bytes, name);
  if (reader.Read<uint32_t>() != kMagic) {
    throw reader.Corrupt("not an EXR file");
  }
  constexpr uint32_t kHasParts = 0x1000;
  const bool has_parts = (reader.Read<uint32_t>() & kHasParts) != 0;
  bool has_size = false;
  // A header ends in an empty name; the headers of several parts end in an
  // empty header.
  for (bool at_start = true;;) {
    const std::string attribute = ReadText(&reader);
    if (attribute.empty()) {
      if (!has_size) {
        throw reader.Corrupt("the EXR header has no dataWindow");
      }
      if (at_start || !has_parts) {
        return;
      }
      at_start = true;
      continue;
    }
    at_start = false;
    const std::string type = ReadText(&reader);
    const std::span<const uint8_t> value = reader.Take(reader.Read<uint32_t>());
    ByteReader rest(value, name);
    TakeExrValue(type, &rest);
    if (rest.NumLeft() > 0) {
      throw reader.Corrupt("the EXR header has an attribute of another size");
    }
    if (attribute == "dataWindow") {
      const auto corners =
          ByteReader(value, name).Read<std::array<int32_t, 4>>();
      RequirePossibleSize(reader,
                          int64_t{corners[2]} - corners[0] + 1,
                          int64_t{corners[3]} - corners[1] + 1,
                          bytes.size());
      has_size = true;
    }
  }
}

}  // namespace tsar
