// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// The description by which a map or another file of this program is recognized;
// a map also after edits.
struct WrittenMap {
  uint64_t hash = 0;  // Content hash, see content_hash.h.
  // Modification time, see path.h; 0: unknown.
  int64_t time = 0;
  // The bits of some values, see SamplePosition(); empty for other files.
  // Applying a mask or a threshold to a map leaves most of them unchanged, and
  // no other program produces the same ones.
  std::vector<uint32_t> samples;
};

// The description as one word for records; the inverse throws
// std::invalid_argument or std::out_of_range for other texts.
std::string ToText(const WrittenMap& map);
WrittenMap WrittenMapFromText(const std::string& text);

constexpr size_t kNumSamples = 128;

// The index of the i-th sample among the values of a file; samples are evenly
// spaced.
constexpr size_t SamplePosition(size_t i, size_t num_values) {
  return (2 * i + 1) * num_values / (2 * kNumSamples);
}

// Reads the samples of a map; throws the errors of ReadMapSize().
std::vector<uint32_t> ReadSamples(const std::filesystem::path& path);

// The description of the map in a file; throws the errors of ReadMapSize() and
// HashFile().
WrittenMap DescribeMap(const std::filesystem::path& path);

// The way in which a file is compared with its description.
enum class Scrutiny {
  // The full content is hashed, before files are deleted or overwritten.
  kContent,
  // A file of the same time and samples (if any) counts as the same, and only
  // others are hashed: for planning work on hundreds of gigabytes.
  kTimeAndSamples,
};

// Whether a file is an unmodified one of these. Throws the errors of
// HashFile().
bool IsAnyOf(const std::filesystem::path& path,
             const std::vector<WrittenMap>& maps,
             Scrutiny scrutiny = Scrutiny::kContent);

}  // namespace tsar
