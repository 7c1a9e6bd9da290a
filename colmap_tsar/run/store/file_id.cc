// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/file_id.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/path.h"

#include <cinttypes>
#include <cstdio>
#include <system_error>

#include <sys/stat.h>

namespace tsar {

std::optional<FileId> FindFileId(const std::filesystem::path& path) {
  struct stat state;
  if (!IsFile(path) || stat(path.c_str(), &state) != 0) {
    return std::nullopt;
  }
  constexpr int64_t kPerSecond = 1000000000;
  return FileId{static_cast<uint64_t>(state.st_size),
                state.st_mtim.tv_sec * kPerSecond + state.st_mtim.tv_nsec};
}

bool IsUnchanged(const std::filesystem::path& path, const FileId& written) {
  const std::optional<FileId> id = FindFileId(path);
  return id && id->num_bytes == written.num_bytes &&
         (id->time == written.time ||
          (written.hash != 0 && HashFile(path) == written.hash));
}

bool AreSameFile(const std::filesystem::path& a,
                 const std::filesystem::path& b) {
  std::error_code error;
  const std::optional<FileId> first = FindFileId(a);
  const std::optional<FileId> second = FindFileId(b);
  return first && second &&
         (std::filesystem::equivalent(a, b, error) ||
          (first->HasSizeAndTimeOf(*second) && HashFile(a) == HashFile(b)));
}

std::string ToText(const FileId& id) {
  std::string text =
      std::to_string(id.num_bytes) + "@" + std::to_string(id.time);
  return id.hash == 0 ? text : text + "#" + HexDigits(id.hash);
}

std::optional<FileId> FileIdFromText(const std::string& text) {
  FileId id;
  const int num_read = std::sscanf(text.c_str(),
                                   "%" SCNu64 "@%" SCNd64 "#%" SCNx64,
                                   &id.num_bytes,
                                   &id.time,
                                   &id.hash);
  return num_read >= 2 && ToText(id) == text ? std::optional(id) : std::nullopt;
}

std::string FileState(const std::filesystem::path& path) {
  const std::optional<FileId> id = FindFileId(path);
  return id ? ToText(*id) : "-";
}

}  // namespace tsar
