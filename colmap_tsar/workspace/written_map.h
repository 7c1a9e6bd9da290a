// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// What is remembered of a map that this program wrote, so that it is known
// again: as it is, and where somebody edited it.
struct WrittenMap {
  // See content_hash.h; nothing where a version of this program wrote the map
  // that computed its fingerprints otherwise.
  std::optional<uint64_t> hash;
  // Time of the file's last change, see file_time.h; 0: not known.
  int64_t time = 0;
  // The bits of some values, see SamplePosition(). A mask or a threshold that
  // is laid over a map leaves most of those as they were, and no other program
  // comes to the same ones.
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

// How a file is compared with what was written.
enum class Scrutiny {
  // All of it is read: before anything is deleted or written over.
  kContent,
  // A file of the same time and samples counts as the same, and only others
  // are read: to find out what is to be done, of hundreds of gigabytes.
  kTimeAndSamples,
};

// Whether a file is one of these maps as it was written: by its fingerprint, or
// by its time and samples where the map has none. Throws what HashFile()
// throws; a file that is no map is none of them.
bool IsAnyOf(const std::filesystem::path& path,
             const std::vector<WrittenMap>& maps,
             Scrutiny scrutiny = Scrutiny::kContent);

}  // namespace tsar
