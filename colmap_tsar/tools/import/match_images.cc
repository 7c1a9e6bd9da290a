// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/match_images.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/image_list.h"
#include "colmap_tsar/tools/import/match_formats.h"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <set>
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

// Reads the images in the order of their indices from a file.
std::vector<int> ReadNumberedImages(const std::filesystem::path& path,
                                    const SparseModel& model) {
  std::vector<int> images;
  std::set<int> seen;
  for (const ListedImage& listed :
       ReadImageList(path, model, OptionName("image_list"))) {
    if (!seen.insert(listed.image).second) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "line " + std::to_string(listed.line) + " names " +
                            model.images[listed.image].name + " a second time",
                        "correct the line");
    }
    images.push_back(listed.image);
  }
  return images;
}

}  // namespace

std::vector<std::filesystem::path> ListEntries(
    const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> entries;
  // Other paths have no entries; a folder that cannot be listed is an error.
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

std::optional<int> TrailingNumber(const std::string& name) {
  const size_t last_other = name.find_last_not_of("0123456789");
  const size_t begin = last_other == std::string::npos ? 0 : last_other + 1;
  int number = 0;
  const auto [end, error] =
      std::from_chars(name.data() + begin, name.data() + name.size(), number);
  if (error != std::errc()) {
    return std::nullopt;
  }
  return number;
}

std::vector<int> OrderImages(const MatchOptions& options,
                             const SparseModel& model) {
  if (!options.image_list.empty()) {
    return ReadNumberedImages(options.image_list, model);
  }
  std::vector<int> images(model.images.size());
  std::iota(images.begin(), images.end(), 0);
  if (options.index_order == IndexOrder::kName) {
    std::ranges::sort(images, [&](int a, int b) {
      return model.images[a].name < model.images[b].name;
    });
  }
  return images;
}

int ImageOfNumber(const std::vector<int>& order,
                  int number,
                  const std::filesystem::path& path) {
  if (static_cast<size_t>(number) >= order.size()) {
    throw Error::File(
        ErrorCode::kMismatch,
        path.string(),
        "its number is " + std::to_string(number) +
            ", but there are images 0 to " + std::to_string(order.size() - 1) +
            " alone",
        "name the images in their order with " + OptionName("image_list"));
  }
  return order[number];
}

}  // namespace tsar
