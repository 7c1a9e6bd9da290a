// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/float_map.h"
#include "colmap_tsar/tools/import/match_formats.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace tsar {
namespace {

using Path = std::filesystem::path;

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

}  // namespace

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

}  // namespace tsar
