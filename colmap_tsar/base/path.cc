// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/path.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <locale>
#include <system_error>

#include <boost/algorithm/string/case_conv.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// Returns the status, or throws if it is unknown.
fs::file_status Known(const fs::file_status& status,
                      const fs::path& path,
                      const std::error_code& error) {
  if (status.type() != fs::file_type::none) {
    return status;
  }
  // No file can have such a name.
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

std::string FoldedCase(const std::string& name) {
  return boost::to_lower_copy(name, std::locale::classic());
}

std::string AdviceForMissing(const fs::path& path, const std::string& advice) {
  std::error_code error;
  const fs::path target = fs::read_symlink(path, error);
  if (!error) {
    return "it is a link to " + target.string() +
           ", which is not there: put that back, or make the link anew";
  }
  const std::string wanted = FoldedCase(path.filename().string());
  error.clear();
  for (fs::directory_iterator entry(path.parent_path(), error), end;
       !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (FoldedCase(name) == wanted) {
      return "there is " + name +
             ", which differs in upper and lower case: rename the file, or the "
             "image in the sparse model";
    }
  }
  return advice;
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
