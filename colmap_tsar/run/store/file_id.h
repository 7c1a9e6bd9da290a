// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace tsar {

// Identifies the version of a file without reading it. Hard links and renaming
// preserve it; if a copy has another time, its content is compared.
struct FileId {
  uint64_t num_bytes = 0;
  int64_t time = 0;   // Of the last change, in nanoseconds.
  uint64_t hash = 0;  // Of the content, see content_hash.h; 0: not known.

  bool operator==(const FileId& other) const = default;
  bool HasSizeAndTimeOf(const FileId& other) const {
    return num_bytes == other.num_bytes && time == other.time;
  }
};

// The size and time of a file; nothing where there is none. Follows links.
std::optional<FileId> FindFileId(const std::filesystem::path& path);

// Whether a file is still this one: of its size and, unless its time is the
// same, of its content.
bool IsUnchanged(const std::filesystem::path& path, const FileId& written);

// Whether both are one file, or have the same size, time and content: all files
// of a copied folder may have the same time, and all maps of a scene the same
// size.
bool AreSameFile(const std::filesystem::path& a,
                 const std::filesystem::path& b);

// "SIZE@TIME", or "SIZE@TIME#HASH" where the hash is known. The inverse returns
// nothing for other texts.
std::string ToText(const FileId& id);
std::optional<FileId> FileIdFromText(const std::string& text);

// The text of FindFileId(), or "-" where there is no such file.
std::string FileState(const std::filesystem::path& path);

}  // namespace tsar
