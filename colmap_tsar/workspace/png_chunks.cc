// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/png_chunks.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include <zlib.h>

namespace tsar {
namespace {

constexpr std::array<uint8_t, 8> kSignature = {
    0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

// Of a chunk, without its content; and the content of the first chunk.
constexpr size_t kFrame = 12;
constexpr size_t kHeaderLength = 13;

uint32_t ReadBigEndian(std::span<const uint8_t> bytes) {
  return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 |
         uint32_t{bytes[2]} << 8 | uint32_t{bytes[3]};
}

struct Chunk {
  std::span<const uint8_t> bytes;  // Length, type, content, checksum.

  std::span<const uint8_t> Type() const { return bytes.subspan(4, 4); }
  std::span<const uint8_t> Content() const {
    return bytes.subspan(8, bytes.size() - kFrame);
  }
  bool Is(std::string_view type) const {
    return std::equal(type.begin(), type.end(), Type().begin());
  }
  // A decoder may ignore what has a small first letter.
  bool IsCritical() const { return (Type()[0] & 0x20) == 0; }
  bool IsWhole() const {
    const std::span<const uint8_t> covered = bytes.subspan(4, bytes.size() - 8);
    const uLong sum =
        crc32_z(crc32_z(0, nullptr, 0), covered.data(), covered.size());
    return sum == ReadBigEndian(bytes.last(4));
  }
};

// The chunk at the beginning of what is left of a file.
std::optional<Chunk> FirstChunk(std::span<const uint8_t> left) {
  if (left.size() < kFrame || ReadBigEndian(left) > left.size() - kFrame) {
    return std::nullopt;
  }
  return Chunk{left.first(ReadBigEndian(left) + kFrame)};
}

// content: that of the first chunk, of kHeaderLength bytes.
PngHeader ParseHeader(std::span<const uint8_t> content) {
  return {ReadBigEndian(content),
          ReadBigEndian(content.subspan(4)),
          content[8],
          content[9],
          content[10],
          content[11],
          content[12]};
}

// Of a file, those that are needed for the pixels.
struct CriticalChunks {
  std::optional<PngHeader> header;
  std::optional<Chunk> palette;
  std::vector<std::span<const uint8_t>> pixels;
  std::optional<Chunk> end;

  // Whether it is one that may stand here.
  bool Add(const Chunk& chunk) {
    if (chunk.Is("IHDR")) {
      header = ParseHeader(chunk.Content());
    } else if (chunk.Is("PLTE")) {
      if (palette || !pixels.empty()) {
        return false;
      }
      palette = chunk;
    } else if (chunk.Is("IDAT")) {
      pixels.push_back(chunk.Content());
    } else if (chunk.Is("IEND")) {
      end = chunk;
      return chunk.Content().empty();
    } else {
      return false;
    }
    return true;
  }
  // Whether it has from 1 to 256 colours of 3 bytes.
  bool HasPossiblePalette() const {
    const size_t size = palette ? palette->Content().size() : 0;
    return size > 0 && size <= 3 * 256 && size % 3 == 0;
  }
};

}  // namespace

std::string FindPngDefect(std::span<const uint8_t> bytes) {
  if (bytes.size() < kSignature.size() ||
      !std::equal(kSignature.begin(), kSignature.end(), bytes.begin())) {
    return "it does not begin as a PNG file";
  }
  CriticalChunks chunks;
  std::span<const uint8_t> left = bytes.subspan(kSignature.size());
  for (bool is_first = true; !chunks.end; is_first = false) {
    const std::optional<Chunk> chunk = FirstChunk(left);
    if (!chunk) {
      return "it breaks off";
    }
    if (chunk->Is("IHDR") != is_first) {
      return is_first ? "it has no header" : "it has two headers";
    }
    if (is_first && chunk->bytes.size() != kFrame + kHeaderLength) {
      return "its header is of another length";
    }
    if (chunk->IsCritical()) {
      if (!chunk->IsWhole()) {
        return "a checksum is wrong";
      }
      if (!chunks.Add(*chunk)) {
        return "it has chunks that make no sense";
      }
    }
    left = left.subspan(chunk->bytes.size());
  }
  if (!chunks.header->IsPossible()) {
    return "its header makes no sense";
  }
  if (chunks.header->HasPalette() && !chunks.HasPossiblePalette()) {
    return "its palette makes no sense";
  }
  return HasAllPngRows(*chunks.header, chunks.pixels)
             ? ""
             : "its pixels cannot be decompressed";
}

std::optional<PngHeader> ReadPngHeader(std::span<const uint8_t> head) {
  static_assert(kPngHeadSize == kSignature.size() + kFrame + kHeaderLength);
  if (head.size() < kPngHeadSize ||
      !std::equal(kSignature.begin(), kSignature.end(), head.begin())) {
    return std::nullopt;
  }
  const std::optional<Chunk> chunk =
      FirstChunk(head.subspan(kSignature.size(), kFrame + kHeaderLength));
  if (!chunk || !chunk->Is("IHDR") ||
      chunk->bytes.size() != kFrame + kHeaderLength || !chunk->IsWhole()) {
    return std::nullopt;
  }
  return ParseHeader(chunk->Content());
}

std::vector<uint8_t> KeepCriticalChunks(std::span<const uint8_t> bytes) {
  std::vector<uint8_t> kept(kSignature.begin(), kSignature.end());
  kept.reserve(bytes.size());
  std::span<const uint8_t> left = bytes.subspan(kSignature.size());
  const bool has_palette =
      ParseHeader(FirstChunk(left).value().Content()).HasPalette();
  for (bool is_last = false; !is_last;) {
    const Chunk chunk = FirstChunk(left).value();
    // A palette in another picture is advice for those who reduce its colours.
    if (chunk.IsCritical() && (has_palette || !chunk.Is("PLTE"))) {
      kept.insert(kept.end(), chunk.bytes.begin(), chunk.bytes.end());
    }
    is_last = chunk.Is("IEND");
    left = left.subspan(chunk.bytes.size());
  }
  return kept;
}

}  // namespace tsar
