// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/input_state.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/text_stream.h"

#include <cinttypes>
#include <cstdint>
#include <cstdio>
#include <system_error>

namespace tsar {

std::string FingerprintOf(const std::string& text) {
  ContentHash hash;
  hash.Update(text.data(), text.size());
  char digits[17];
  std::snprintf(digits, sizeof(digits), "%016" PRIx64, hash.Value());
  return digits;
}

std::string FingerprintOf(const Camera& camera) {
  TextStream text;
  text << std::hexfloat << camera.width << " " << camera.height;
  for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) {
    text << " " << value;
  }
  for (const double value : camera.rotation.reshaped()) {
    text << " " << value;
  }
  for (const double value : camera.translation) {
    text << " " << value;
  }
  return FingerprintOf(text.str());
}

std::string FileState(const std::filesystem::path& path) {
  std::error_code error;
  const uintmax_t size = std::filesystem::file_size(path, error);
  if (error) {
    return "-";
  }
  const auto time = std::filesystem::last_write_time(path, error);
  return std::to_string(size) + "@" +
         std::to_string(time.time_since_epoch().count());
}

std::string DescribeChanges(const std::vector<ChangedInput>& changes) {
  std::string text;
  for (size_t i = 0; i < changes.size(); ++i) {
    const char* separator = i == 0                   ? ""
                            : i + 1 < changes.size() ? ", "
                                                     : " and ";
    text += separator + changes[i].name;
  }
  const bool is_plural = changes.size() > 1 || changes.front().is_plural;
  return text + (is_plural ? " have changed" : " has changed");
}

}  // namespace tsar
