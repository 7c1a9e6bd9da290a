// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/written_map.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_io.h"

#include <algorithm>
#include <charconv>
#include <cinttypes>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <system_error>

namespace tsar {
namespace {

constexpr size_t kDigits = 8;  // Hexadecimal digits of a sample.

template <typename T>
T FromDigits(const std::string& text, int base) {
  T value = 0;
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value, base);
  if (text.empty() || result.ec != std::errc() || result.ptr != end) {
    throw std::invalid_argument(text);
  }
  return value;
}

// Both are needed: an edit changes the time but may leave all samples
// unchanged.
bool HasTimeAndSamples(const std::filesystem::path& path,
                       const WrittenMap& map) {
  if (map.time == 0 || TimeOf(path) != map.time) {
    return false;
  }
  try {
    return map.samples.empty() || ReadSamples(path) == map.samples;
  } catch (const Error& error) {
    if (error.Code() == ErrorCode::kCorrupt) {
      return false;
    }
    throw;
  }
}

}  // namespace

std::string ToText(const WrittenMap& map) {
  char text[64];
  std::snprintf(
      text, sizeof(text), "%016" PRIx64 "@%" PRId64 ":", map.hash, map.time);
  std::string all = text;
  for (const uint32_t sample : map.samples) {
    std::snprintf(text, sizeof(text), "%08" PRIx32, sample);
    all += text;
  }
  return all;
}

WrittenMap WrittenMapFromText(const std::string& text) {
  const size_t at = text.find('@');
  const size_t colon = text.find(':');
  if (at == std::string::npos || colon == std::string::npos || colon < at) {
    throw std::invalid_argument(text);
  }
  WrittenMap map;
  map.hash = FromDigits<uint64_t>(text.substr(0, at), 16);
  map.time = FromDigits<int64_t>(text.substr(at + 1, colon - at - 1), 10);
  for (size_t i = colon + 1; i < text.size(); i += kDigits) {
    map.samples.push_back(FromDigits<uint32_t>(text.substr(i, kDigits), 16));
  }
  return map;
}

std::vector<uint32_t> ReadSamples(const std::filesystem::path& path) {
  const size_t num_values = ReadMapSize(path).NumValues();
  InputFile file(path);
  const uintmax_t header_size = file.Size() - num_values * sizeof(uint32_t);
  std::vector<uint32_t> samples(kNumSamples);
  for (size_t i = 0; i < kNumSamples; ++i) {
    file.seekg(static_cast<std::streamoff>(
        header_size + SamplePosition(i, num_values) * sizeof(uint32_t)));
    file.read(reinterpret_cast<char*>(&samples[i]), sizeof(samples[i]));
  }
  if (!file) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "reading failed",
                      "check the disk and the file's permissions");
  }
  return samples;
}

WrittenMap DescribeMap(const std::filesystem::path& path) {
  return {HashFile(path), TimeOf(path), ReadSamples(path)};
}

bool IsAnyOf(const std::filesystem::path& path,
             const std::vector<WrittenMap>& maps,
             Scrutiny scrutiny) {
  // The hash is computed lazily, since it reads the full file.
  std::optional<uint64_t> hash;
  return std::ranges::any_of(maps, [&](const WrittenMap& map) {
    if (scrutiny == Scrutiny::kTimeAndSamples && HasTimeAndSamples(path, map)) {
      return true;
    }
    if (!hash) {
      hash = HashFile(path);
    }
    return hash == map.hash;
  });
}

}  // namespace tsar
