// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/tools/import/match_formats.h"

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>

namespace tsar {
namespace {

using Path = std::filesystem::path;

std::string WithoutExtension(const std::string& name) {
  return Path(name).replace_extension().generic_string();
}

// The files of depth images below a folder, by image.
class NamedFiles {
 public:
  NamedFiles(const MatchOptions& options, const SparseModel& model)
      : model_(model), by_number_(!options.image_list.empty()) {
    if (by_number_) {
      order_ = OrderImages(options, model);
      return;
    }
    for (size_t i = 0; i < model.images.size(); ++i) {
      const std::string& name = model.images[i].name;
      const auto index = static_cast<int>(i);
      images_of_key_[name].insert(index);
      images_of_key_[WithoutExtension(name)].insert(index);
    }
  }

  std::map<int, Path> Find(const Path& folder) {
    std::map<int, Path> files;
    num_without_image_ = 0;
    for (const Path& path : ListDepthImages(folder)) {
      const int image = ImageOf(folder, path);
      if (image < 0) {
        num_without_image_ += IsFile(path) ? 1 : 0;
        continue;
      }
      RequireFile(path);
      const auto [entry, is_new] = files.emplace(image, path);
      if (!is_new) {
        throw Error::File(ErrorCode::kMismatch,
                          path.string(),
                          "is for the image " + model_.images[image].name +
                              ", and so is " + entry->second.string(),
                          "take one of the two away");
      }
    }
    return files;
  }

  int NumWithoutImage() const { return num_without_image_; }

 private:
  static std::vector<Path> ListDepthImages(const Path& folder) {
    std::vector<Path> files;
    for (const TreeEntry& entry : ListTree({folder, {}})) {
      if (IsDepthImageName(entry.path)) {
        files.push_back(entry.path);
      }
    }
    std::ranges::sort(files);
    return files;
  }

  int ImageOf(const Path& folder, const Path& path) const {
    if (by_number_) {
      const std::optional<int> number = TrailingNumber(path.stem().string());
      return number ? ImageOfNumber(order_, *number, path) : -1;
    }
    const std::string key =
        WithoutExtension(path.lexically_relative(folder).generic_string());
    const auto images = images_of_key_.find(key);
    if (images == images_of_key_.end()) {
      return -1;
    }
    if (images->second.size() > 1) {
      const auto first = static_cast<size_t>(*images->second.begin());
      const auto second = static_cast<size_t>(*images->second.rbegin());
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "may be for the image " + model_.images[first].name +
                            " or for " + model_.images[second].name,
                        "put the image's extension before the file's own");
    }
    return *images->second.begin();
  }

  const SparseModel& model_;
  bool by_number_;
  std::vector<int> order_;
  std::map<std::string, std::set<int>> images_of_key_;
  int num_without_image_ = 0;
};

}  // namespace

int MatchDepthImages(const MatchOptions& options,
                     const SparseModel& model,
                     MapCollector* collector) {
  NamedFiles named(options, model);
  std::map<int, Path> normals;
  if (!options.normal_path.empty()) {
    RequireFolder(options.normal_path, OptionName("normal_path"));
    normals = named.Find(options.normal_path);
  }
  for (const auto& [image, path] : named.Find(options.input_path)) {
    ExternalFiles files;
    files.depth = path;
    const auto normal = normals.find(image);
    if (normal != normals.end()) {
      files.normal = normal->second;
    }
    collector->Add(image, std::move(files));
  }
  if (collector->Files().empty()) {
    throw Error::File(
        ErrorCode::kNotFound,
        options.input_path.string(),
        "no depth image (PNG, EXR, TIFF, PFM, NPY) in it is called as an image "
        "of the workspace, such as " +
            (model.images.empty() ? "..."
                                  : WithoutExtension(model.images[0].name)) +
            ".png",
        "check " + OptionName("input_path") + ", or number the files and use " +
            OptionName("image_list"));
  }
  return named.NumWithoutImage();
}

}  // namespace tsar
