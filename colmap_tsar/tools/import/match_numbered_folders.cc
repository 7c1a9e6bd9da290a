// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/tools/import/match_formats.h"

#include <cstdio>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

namespace tsar {
namespace {

using Path = std::filesystem::path;

bool HasFile(const Path& path) {
  const bool is_there = std::filesystem::exists(SymlinkStatus(path));
  if (is_there) {
    RequireFile(path);
  }
  return is_there;
}

// The first existing file of these names with one of the extensions.
Path FindFile(const Path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    for (const char* extension : {".dmb", ".bin"}) {
      Path path = folder / (std::string(name) + extension);
      if (HasFile(path)) {
        return path;
      }
    }
  }
  return {};
}

struct NumberedFolder {
  int number = 0;
  Path path;
};

Path FindGeometricDepth(const Path& folder) {
  return FindFile(folder, {"depths_geom", "depth_geom"});
}
Path FindPlainDepth(const Path& folder) {
  // Gipuma calls depth "disp".
  return FindFile(folder, {"depths", "depth", "disp"});
}

std::vector<NumberedFolder> FindNumberedFolders(const Path& folder) {
  std::vector<NumberedFolder> found;
  for (const Path& path : ListEntries(folder)) {
    const std::optional<int> number = TrailingNumber(path.filename().string());
    if (number && IsFolder(path) &&
        (!FindGeometricDepth(path).empty() || !FindPlainDepth(path).empty())) {
      found.push_back({*number, path});
    }
  }
  return found;
}

// Finds numbered folders in the folder or in the one subfolder with some.
std::vector<NumberedFolder> FindProgramFolder(const Path& input) {
  std::vector<NumberedFolder> found = FindNumberedFolders(input);
  if (!found.empty()) {
    return found;
  }
  Path chosen;
  for (const Path& folder : ListEntries(input)) {
    std::vector<NumberedFolder> here = FindNumberedFolders(folder);
    if (here.empty()) {
      continue;
    }
    if (!found.empty()) {
      throw Error::File(ErrorCode::kMismatch,
                        input.string(),
                        "there are maps in " + chosen.filename().string() +
                            " and in " + folder.filename().string(),
                        "give one of the two as " + OptionName("input_path"));
    }
    found = std::move(here);
    chosen = folder;
  }
  if (found.empty()) {
    throw Error::File(
        ErrorCode::kNotFound,
        input.string(),
        "no folder in it is called like 2333_00000000 and holds depths.dmb",
        "check " + OptionName("input_path") + " and " + OptionName("format"));
  }
  return found;
}

ExternalFiles FindFilesOf(const NumberedFolder& folder,
                          const MatchOptions& options) {
  ExternalFiles files;
  const Path geometric = FindGeometricDepth(folder.path);
  const Path plain = FindPlainDepth(folder.path);
  const bool take_geometric =
      !geometric.empty() &&
      (options.type == MapType::kGeometric || plain.empty());
  files.depth = take_geometric ? geometric : plain;
  if (take_geometric || geometric.empty()) {
    files.normal = FindFile(folder.path, {"normals", "normal"});
    files.cost = FindFile(folder.path, {"costs", "cost"});
  }
  char name[32];
  std::snprintf(name, sizeof(name), "%08d_cam.txt", folder.number);
  for (const Path& cams : {folder.path.parent_path().parent_path() / "cams",
                           folder.path.parent_path() / "cams"}) {
    if (files.camera.empty() && HasFile(cams / name)) {
      files.camera = cams / name;
    }
  }
  return files;
}

}  // namespace

void MatchNumberedFolders(const MatchOptions& options,
                          const SparseModel& model,
                          MapCollector* collector) {
  const std::vector<int> order = OrderImages(options, model);
  for (const NumberedFolder& folder : FindProgramFolder(options.input_path)) {
    collector->Add(ImageOfNumber(order, folder.number, folder.path),
                   FindFilesOf(folder, options));
  }
}

}  // namespace tsar
