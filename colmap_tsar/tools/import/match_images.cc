// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/match_images.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/float_map.h"
#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/tools/import/match_formats.h"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <utility>

namespace tsar {
namespace {

using Path = std::filesystem::path;

// The path without "." and a trailing slash, so that it has a parent.
Path Normalized(const Path& path) {
  const Path normal = std::filesystem::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// Reads the images in the order of their indices from a file.
std::vector<int> ReadNumberedImages(const Path& path,
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

// The index of the image that matches a stored name, or -1.
int FindStoredName(const SparseModel& model,
                   std::string stored,
                   const Path& path) {
  std::ranges::replace(stored, '\\', '/');
  int best = -1;
  size_t best_length = 0;
  std::vector<int> same_stem;
  for (size_t i = 0; i < model.images.size(); ++i) {
    const std::string& name = model.images[i].name;
    if ((stored == name || stored.ends_with("/" + name)) &&
        name.size() > best_length) {
      best = static_cast<int>(i);
      best_length = name.size();
    }
    if (Path(stored).stem() == Path(name).stem()) {
      same_stem.push_back(static_cast<int>(i));
    }
  }
  if (best >= 0 || same_stem.empty()) {
    return best;
  }
  if (same_stem.size() > 1) {
    throw Error::File(
        ErrorCode::kMismatch,
        path.string(),
        "is for the image " + stored + ", which may be " +
            model.images[same_stem[0]].name + " or " +
            model.images[same_stem[1]].name,
        "name the images in their order with " + OptionName("image_list"));
  }
  return same_stem[0];
}

// Matches files of kOpenMvs; returns the number of those without an image.
int MatchDmaps(const MatchOptions& options,
               const SparseModel& model,
               MapCollector* collector) {
  const bool by_number = !options.image_list.empty();
  const std::vector<int> order = OrderImages(options, model);
  int num_without_image = 0;
  std::string unknown;
  for (const Path& path : ListEntries(options.input_path)) {
    const std::string stem = path.stem().string();
    const std::optional<int> number = TrailingNumber(stem);
    // Others, such as depth0012.geo.dmap, are of earlier passes.
    if (path.extension() != ".dmap" || !number || !stem.starts_with("depth")) {
      continue;
    }
    ExternalFiles files;
    files.depth = path;
    if (by_number) {
      collector->Add(ImageOfNumber(order, *number, path), std::move(files));
      continue;
    }
    const std::string stored =
        ParseDmapImageName(ReadFileBytes(path, kMaxDmapNameEnd), path.string());
    const int image = FindStoredName(model, stored, path);
    if (image >= 0) {
      collector->Add(image, std::move(files));
    } else {
      ++num_without_image;
      unknown = stored;
    }
  }
  if (collector->Files().empty()) {
    throw Error::File(
        ErrorCode::kNotFound,
        options.input_path.string(),
        num_without_image == 0 ? "no file in it is called like depth0000.dmap"
                               : "its maps are for images such as " + unknown +
                                     ", which are not in the sparse model",
        num_without_image == 0 ? "check " + OptionName("input_path")
                               : "name the images in their order with " +
                                     OptionName("image_list"));
  }
  return num_without_image;
}

}  // namespace

std::vector<Path> ListEntries(const Path& folder) {
  std::vector<Path> entries;
  // Other paths have no entries; a folder that cannot be listed is an error.
  if (IsFolder(folder)) {
    const Folder open({folder, {}});
    for (const Folder::Entry& entry : open.List()) {
      entries.push_back(folder / entry.name);
    }
  }
  return entries;
}

bool IsFolder(const Path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

void RequireFile(const Path& path) {
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

void RequireFolder(const Path& folder, const std::string& option) {
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

int ImageOfNumber(const std::vector<int>& order, int number, const Path& path) {
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
