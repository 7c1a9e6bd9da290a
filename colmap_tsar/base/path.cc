// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/path.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <system_error>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// What the system says, or throws where it says nothing.
fs::file_status Known(const fs::file_status& status,
                      const fs::path& path,
                      const std::error_code& error) {
  if (status.type() != fs::file_type::none) {
    return status;
  }
  // No file system holds it.
  if (error == std::errc::filename_too_long) {
    return fs::file_status(fs::file_type::not_found);
  }
  throw Error::File(ErrorCode::kIo,
                    path.string(),
                    "cannot be looked at (" + error.message() + ")",
                    "check the disk and the permissions of its folders");
}

fs::file_status StatusOf(const fs::path& path) {
  std::error_code error;
  return Known(fs::status(path, error), path, error);
}

}  // namespace

bool Exists(const fs::path& path) { return fs::exists(StatusOf(path)); }

bool IsFile(const fs::path& path) {
  return fs::is_regular_file(StatusOf(path));
}

fs::file_status SymlinkStatus(const fs::path& path) {
  std::error_code error;
  return Known(fs::symlink_status(path, error), path, error);
}

bool IsWithin(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end())
             .first == folder.end();
}

}  // namespace tsar
