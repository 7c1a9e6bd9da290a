// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tsar {

// What is remembered of a map or another file of this program, so that it is
// known again: as it is, and a map also where somebody edited it.
struct WrittenMap {
  uint64_t hash = 0;  // See content_hash.h.
  // Time of the file's last change, see file_time.h; 0: not known.
  int64_t time = 0;
  // The bits of some values, see SamplePosition(); empty for other files than
  // maps. A mask or a threshold that is laid over a map leaves most of those as
  // they were, and no other program comes to the same ones.
  std::vector<uint32_t> samples;
};

// As one word for records; the inverse throws std::invalid_argument or
// std::out_of_range for other texts.
std::string ToText(const WrittenMap& map);
WrittenMap WrittenMapFromText(const std::string& text);

constexpr size_t kNumSamples = 128;

// Which of the values in a file the i-th sample is: they are spread evenly.
constexpr size_t SamplePosition(size_t i, size_t num_values) {
  return (2 * i + 1) * num_values / (2 * kNumSamples);
}

// The samples of a map in a file; throws what ReadMapSize() throws.
std::vector<uint32_t> ReadSamples(const std::filesystem::path& path);

// What is remembered of the map in a file; throws what ReadMapSize() and
// HashFile() throw.
WrittenMap DescribeMap(const std::filesystem::path& path);

// How a file is compared with what was written.
enum class Scrutiny {
  // All of it is read: before anything is deleted or written over.
  kContent,
  // A file of the same time and samples, or of the same time where there are
  // none, counts as the same, and only others are read: to find out what is to
  // be done, of hundreds of gigabytes.
  kTimeAndSamples,
};

// Whether a file is one of these as it was written. Throws what HashFile()
// throws.
bool IsAnyOf(const std::filesystem::path& path,
             const std::vector<WrittenMap>& maps,
             Scrutiny scrutiny = Scrutiny::kContent);

}  // namespace tsar
