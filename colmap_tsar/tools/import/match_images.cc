// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/match_images.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/float_map.h"
#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/io/map_files.h"

#include <algorithm>
#include <charconv>
#include <initializer_list>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <system_error>

namespace tsar {
namespace {

using Path = std::filesystem::path;

bool IsFolder(const Path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

void RequireFolder(const Path& folder, const std::string& option) {
  if (!IsFolder(folder)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "no such folder",
                      "check " + OptionName(option));
  }
}

// Whether there is anything with the name of a map, which has to be a file.
bool HasMap(const Path& path) {
  if (!std::filesystem::exists(SymlinkStatus(path))) {
    return false;
  }
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
  return true;
}

// A folder's entries in an order that does not depend on the file system; those
// of other paths are none.
std::vector<Path> ListEntries(const Path& folder) {
  std::vector<Path> entries;
  if (IsFolder(folder)) {
    for (const FolderEntry& entry : ListFolder({folder, {}})) {
      entries.push_back(entry.path);
    }
  }
  return entries;
}

// The trailing number of a name: 12 for "2333_00000012".
std::optional<int> TrailingNumber(const std::string& name) {
  const size_t begin = name.find_last_not_of("0123456789") + 1;
  int number = 0;
  const auto [end, error] =
      std::from_chars(name.data() + begin, name.data() + name.size(), number);
  return error == std::errc() ? std::optional(number) : std::nullopt;
}

std::string WithoutExtension(const std::string& name) {
  return Path(name).replace_extension().generic_string();
}

std::string AdviceToOrder() {
  return "name the images in their order with " + OptionName("image_list");
}

// The first existing file of these names with one of the extensions.
Path FindFile(const Path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    for (const char* extension : {".dmb", ".bin"}) {
      Path path = folder / (std::string(name) + extension);
      if (HasMap(path)) {
        return path;
      }
    }
  }
  return {};
}

// The files of the images 0, 1, 2, ... of another program, by the folders of
// these.
using NumberedFolders = std::vector<std::pair<Path, ExternalFiles>>;

// Those folders in a folder that have a depth map.
NumberedFolders FindNumberedFolders(const Path& parent, MapType type) {
  NumberedFolders found;
  for (const Path& folder : ListEntries(parent)) {
    const auto number = TrailingNumber(folder.filename().string());
    if (!number || !IsFolder(folder)) {
      continue;
    }
    const Path geometric = FindFile(folder, {"depths_geom", "depth_geom"});
    // Gipuma calls depth "disp".
    const Path plain = FindFile(folder, {"depths", "depth", "disp"});
    const bool take_geometric =
        !geometric.empty() && (type == MapType::kGeometric || plain.empty());
    ExternalFiles files;
    files.depth = take_geometric ? geometric : plain;
    if (files.depth.empty()) {
      continue;
    }
    if (take_geometric || geometric.empty()) {
      files.normal = FindFile(folder, {"normals", "normal"});
    }
    const std::string name = Formatted("%08d_cam.txt", *number);
    for (const Path& cams : {parent.parent_path() / "cams", parent / "cams"}) {
      if (files.camera.empty() && HasMap(cams / name)) {
        files.camera = cams / name;
      }
    }
    files.image = *number;
    found.emplace_back(folder, std::move(files));
  }
  return found;
}

// Finds numbered folders in the folder or in the one subfolder with some.
NumberedFolders FindProgramFolder(const Path& input, MapType type) {
  NumberedFolders found = FindNumberedFolders(input, type);
  if (!found.empty()) {
    return found;
  }
  for (const Path& folder : ListEntries(input)) {
    NumberedFolders here = FindNumberedFolders(folder, type);
    if (!here.empty() && !found.empty()) {
      throw Error::File(ErrorCode::kMismatch,
                        input.string(),
                        "there are maps in " +
                            found[0].first.parent_path().filename().string() +
                            " and in " + folder.filename().string(),
                        "give one of the two as " + OptionName("input_path"));
    }
    if (!here.empty()) {
      found = std::move(here);
    }
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
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "is for the image " + stored + ", which may be " +
                          model.images[same_stem[0]].name + " or " +
                          model.images[same_stem[1]].name,
                      AdviceToOrder());
  }
  return same_stem[0];
}

// The images 0, 1, 2, ... of another program as indices into
// SparseModel::images.
std::vector<int> OrderImages(const Path& image_list, const SparseModel& model) {
  std::vector<int> images;
  if (image_list.empty()) {
    images.resize(model.images.size());
    std::iota(images.begin(), images.end(), 0);
    return images;
  }
  std::set<int> seen;
  for (const ListedImage& listed :
       ReadImageList(image_list, model, OptionName("image_list"))) {
    if (!seen.insert(listed.image).second) {
      throw Error::File(ErrorCode::kMismatch,
                        image_list.string(),
                        "line " + std::to_string(listed.line) + " names " +
                            model.images[listed.image].name + " a second time",
                        "correct the line");
    }
    images.push_back(listed.image);
  }
  return images;
}

class Matcher {
 public:
  Matcher(const MatchOptions& options, const SparseModel& model)
      : options_(options),
        // Without "." and a trailing slash, so that it has a parent.
        input_((std::filesystem::absolute(options.input_path) / "")
                   .lexically_normal()
                   .parent_path()),
        model_(model) {
    RequireFolder(input_, "input_path");
    order_ = OrderImages(options.image_list, model);
  }

  MatchedMaps Match() {
    if (options_.format == ExternalFormat::kOpenMvs) {
      MatchDmaps();
    } else if (options_.format == ExternalFormat::kDepth) {
      MatchDepthImages();
    } else {
      for (const auto& [path, files] :
           FindProgramFolder(input_, options_.type)) {
        Add(ImageOf(files.image, path), files);
      }
    }
    MatchedMaps matched;
    matched.num_without_image = num_without_image_;
    for (const auto& [image, files] : found_) {
      matched.files.push_back(files);
    }
    return matched;
  }

 private:
  int ImageOf(int number, const Path& path) const {
    if (static_cast<size_t>(number) >= order_.size()) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "its number is " + std::to_string(number) +
                            ", but there are images 0 to " +
                            std::to_string(order_.size() - 1) + " alone",
                        AdviceToOrder());
    }
    return order_[number];
  }

  void RequireFirst(int image, const Path& path, const Path& other) const {
    if (!other.empty()) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "is for the image " + model_.images[image].name +
                            ", and so is " + other.string(),
                        "take one of the two away, or " + AdviceToOrder());
    }
  }

  void Add(int image, const ExternalFiles& files) {
    ExternalFiles& entry = found_[image];
    RequireFirst(image, files.depth, entry.depth);
    entry = files;
    entry.image = image;
  }

  void MatchDmaps() {
    const bool by_number = !options_.image_list.empty();
    std::string unknown;
    for (const Path& path : ListEntries(input_)) {
      const std::string stem = path.stem().string();
      const std::optional<int> number = TrailingNumber(stem);
      // Others, such as depth0012.geo.dmap, are of earlier passes.
      if (path.extension() != ".dmap" || !number ||
          !stem.starts_with("depth")) {
        continue;
      }
      const std::string stored =
          by_number ? ""
                    : ParseDmapImageName(ReadFileBytes(path, kMaxDmapNameEnd),
                                         path.string());
      const int image = by_number ? ImageOf(*number, path)
                                  : FindStoredName(model_, stored, path);
      if (image >= 0) {
        ExternalFiles files;
        files.depth = path;
        Add(image, files);
      } else {
        ++num_without_image_;
        unknown = stored;
      }
    }
    if (found_.empty()) {
      throw Error::File(ErrorCode::kNotFound,
                        input_.string(),
                        unknown.empty()
                            ? "no file in it is called like depth0000.dmap"
                            : "its maps are for images such as " + unknown +
                                  ", which are not in the sparse model",
                        unknown.empty() ? "check " + OptionName("input_path")
                                        : AdviceToOrder());
    }
  }

  // The depth images or normals below a folder, by image. num_without_image:
  // counts the files of images that are not in the model.
  std::map<int, Path> FindNamedFiles(const Path& folder,
                                     int* num_without_image) const {
    const bool by_number = !options_.image_list.empty();
    std::map<std::string, std::set<int>> images_of_key;
    for (const int image : order_) {
      const std::string& name = model_.images[image].name;
      images_of_key[name].insert(image);
      images_of_key[WithoutExtension(name)].insert(image);
    }
    std::map<int, Path> files;
    for (const FolderEntry& entry : ListTree({folder, {}})) {
      const Path path = entry.path;
      if (!IsDepthImageName(path)) {
        continue;
      }
      const std::optional<int> number = TrailingNumber(path.stem().string());
      const auto named = images_of_key.find(
          WithoutExtension(path.lexically_relative(folder).generic_string()));
      if (by_number ? !number : named == images_of_key.end()) {
        *num_without_image += entry.is_folder ? 0 : 1;
        continue;
      }
      if (!by_number && named->second.size() > 1) {
        throw Error::File(ErrorCode::kMismatch,
                          path.string(),
                          "may be for the image " +
                              model_.images[*named->second.begin()].name +
                              " or for " +
                              model_.images[*named->second.rbegin()].name,
                          "put the image's extension before the file's own");
      }
      const int image =
          by_number ? ImageOf(*number, path) : *named->second.begin();
      HasMap(path);
      RequireFirst(image, path, files[image]);
      files[image] = path;
    }
    return files;
  }

  void MatchDepthImages() {
    std::map<int, Path> normals;
    if (!options_.normal_path.empty()) {
      RequireFolder(options_.normal_path, "normal_path");
      int ignored = 0;
      normals = FindNamedFiles(options_.normal_path, &ignored);
    }
    for (const auto& [image, path] :
         FindNamedFiles(input_, &num_without_image_)) {
      found_[image] = {image, path, normals[image], {}};
      if (!options_.normal_path.empty() && normals[image].empty()) {
        throw Error::File(ErrorCode::kNotFound,
                          options_.normal_path.string(),
                          "holds no normal map for " + path.string(),
                          "add it, or leave " + OptionName("normal_path") +
                              " out, so that depth gives the normals");
      }
    }
    if (found_.empty()) {
      throw Error::File(
          ErrorCode::kNotFound,
          input_.string(),
          "no depth image (PNG, EXR, TIFF, PFM, NPY) in it is called as an "
          "image of the workspace, such as " +
              WithoutExtension(model_.images[0].name) + ".png",
          "check " + OptionName("input_path") +
              ", or number the files and use " + OptionName("image_list"));
    }
  }

  const MatchOptions& options_;
  const Path input_;
  const SparseModel& model_;
  std::vector<int> order_;
  std::map<int, ExternalFiles> found_;  // By image.
  int num_without_image_ = 0;
};

}  // namespace

MatchedMaps MatchImages(const MatchOptions& options, const SparseModel& model) {
  return Matcher(options, model).Match();
}

}  // namespace tsar
