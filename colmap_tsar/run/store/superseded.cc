// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/superseded.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/io/map_paths.h"

#include <string>
#include <system_error>

namespace tsar {
namespace {

bool IsTaken(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::symlink_status(path, error).type() !=
         std::filesystem::file_type::not_found;
}

}  // namespace

ContainedPath Supersede(const ContainedPath& path, const ContainedPath& map) {
  const ContainedPath folder = GetSupersededFolder(map.Root());
  const std::filesystem::path name =
      map.Relative().lexically_relative("stereo");
  ContainedPath target = folder / name;
  for (int number = 2; IsTaken(target); ++number) {
    target = folder / (name.string() + "." + std::to_string(number));
  }
  CreateFolders(target.Parent());
  RenameFile(path, target);
  return target;
}

}  // namespace tsar
