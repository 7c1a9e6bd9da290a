// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/input_folders.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"

#include <system_error>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// The canonical form of a path that need not exist. A path that cannot be
// looked up cannot be written to either, and the writer reports that.
fs::path Canonical(const fs::path& path) {
  std::error_code error;
  const fs::path canonical = fs::weakly_canonical(fs::absolute(path), error);
  return error ? path : canonical;
}

// The name of the input folder in which a path is or lies, or nothing: of the
// innermost workspace around it, a folder that holds two of the three.
std::string FindInputFolderAround(const fs::path& path) {
  for (fs::path below = path; below.has_relative_path();
       below = below.parent_path()) {
    int count = 0;
    std::string found;
    for (const char* name : {"images", "sparse", "stereo"}) {
      std::error_code error;
      count += fs::is_directory(below.parent_path() / name, error) ? 1 : 0;
      found = below.filename() == name ? name : found;
    }
    if (count >= 2) {
      return found;
    }
  }
  return "";
}

}  // namespace

void RequireOutsideInputs(const fs::path& root,
                          const fs::path& path,
                          const std::string& option) {
  // A link of this name would be replaced in place, or followed to its target.
  const fs::path place =
      Canonical(path.parent_path().empty() ? fs::path(".")
                                           : path.parent_path()) /
      path.filename();
  std::string folder;
  for (const fs::path& file : {place, Canonical(path)}) {
    folder = folder.empty() ? FindInputFolderAround(file) : folder;
    for (const char* name : {"images", "sparse", "sparse/0", "stereo"}) {
      folder = IsWithin(file, Canonical(root / name)) ? name : folder;
    }
  }
  if (!folder.empty()) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "is in the folder " + folder + " of a workspace",
                      "choose another " + option);
  }
}

}  // namespace tsar
