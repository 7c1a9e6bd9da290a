// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/match_images.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/tools/import/match_formats.h"

#include <algorithm>
#include <string>
#include <system_error>

namespace tsar {
namespace {

// The path without "." and a trailing slash, so that it has a parent.
std::filesystem::path Normalized(const std::filesystem::path& path) {
  const std::filesystem::path normal =
      std::filesystem::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

}  // namespace

std::vector<std::filesystem::path> ListEntries(
    const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> entries;
  // A path that is no folder has no entries; a folder that cannot be listed is
  // an error.
  if (IsFolder(folder)) {
    const Folder open({folder, {}});
    for (const Folder::Entry& entry : open.List()) {
      entries.push_back(folder / entry.name);
    }
  }
  return entries;
}

bool IsFolder(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

void RequireFile(const std::filesystem::path& path) {
  const InputFile file(path);
  if (file.IsMissing() || file.IsNoFile()) {
    throw Error::File(
        ErrorCode::kUnsupported,
        path.string(),
        "has the name of a map, but " +
            (file.IsMissing() ? std::string("it is a link that leads nowhere")
                              : file.Reason()),
        "put the map there, or take it away");
  }
}

void RequireFolder(const std::filesystem::path& folder,
                   const std::string& option) {
  if (!IsFolder(folder)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "no such folder",
                      std::string("check ") + option);
  }
}

void MapCollector::Add(int image, ExternalFiles files) {
  files.image = image;
  const auto [entry, is_new] = files_.emplace(image, files);
  if (!is_new) {
    throw Error::File(
        ErrorCode::kMismatch,
        files.depth.string(),
        "is for the image " + model_.images[image].name + ", and so is " +
            entry->second.depth.string(),
        "take one of the two away, or name the images in their order with " +
            OptionName("image_list"));
  }
}

MatchedMaps MatchImages(const MatchOptions& options, const SparseModel& model) {
  MatchOptions normal = options;
  normal.input_path = Normalized(options.input_path);
  RequireFolder(normal.input_path, OptionName("input_path"));
  MapCollector collector(model);
  MatchedMaps matched;
  if (options.format == ExternalFormat::kOpenMvs) {
    matched.num_without_image = MatchDmaps(normal, model, &collector);
  } else if (options.format == ExternalFormat::kDepth) {
    matched.num_without_image = MatchDepthImages(normal, model, &collector);
  } else {
    MatchNumberedFolders(normal, model, &collector);
  }
  for (const auto& [image, files] : collector.Files()) {
    matched.files.push_back(files);
  }
  return matched;
}

}  // namespace tsar
