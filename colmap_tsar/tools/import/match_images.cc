// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/match_images.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/dense_maps.h"
#include "colmap_tsar/io/float_map.h"
#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/io/map_files.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <initializer_list>
#include <map>
#include <numeric>
#include <set>
#include <system_error>

namespace tsar {
namespace {

using Path = std::filesystem::path;

// The path without "." and a trailing slash, so that it has a parent.
Path Normalized(const Path& path) {
  const Path normal = std::filesystem::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

bool IsFolder(const Path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

void RequireFolder(const Path& folder, const std::string& option) {
  if (!IsFolder(folder)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "no such folder",
                      std::string("check ") + option);
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
    const Folder open({folder, {}});
    for (const Folder::Entry& entry : open.List()) {
      entries.push_back(folder / entry.name);
    }
  }
  return entries;
}

Error TwoMaps(const Path& path, const std::string& image, const Path& other) {
  return Error::File(
      ErrorCode::kMismatch,
      path.string(),
      "is for the image " + image + ", and so is " + other.string(),
      "take one of the two away, or name the images in their order with " +
          OptionName("image_list"));
}

// The files of all images found so far, by ascending image.
using FilesOfImages = std::map<int, ExternalFiles>;

void AddFiles(const SparseModel& model,
              int image,
              ExternalFiles files,
              FilesOfImages* found) {
  files.image = image;
  const auto [entry, is_new] = found->emplace(image, files);
  if (!is_new) {
    throw TwoMaps(files.depth, model.images[image].name, entry->second.depth);
  }
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

Path FindGeometricDepth(const Path& folder) {
  return FindFile(folder, {"depths_geom", "depth_geom"});
}

Path FindPlainDepth(const Path& folder) {
  // Gipuma calls depth "disp".
  return FindFile(folder, {"depths", "depth", "disp"});
}

std::vector<Path> FindNumberedFolders(const Path& folder) {
  std::vector<Path> found;
  for (const Path& path : ListEntries(folder)) {
    if (TrailingNumber(path.filename().string()) && IsFolder(path) &&
        (!FindGeometricDepth(path).empty() || !FindPlainDepth(path).empty())) {
      found.push_back(path);
    }
  }
  return found;
}

// Finds numbered folders in the folder or in the one subfolder with some.
std::vector<Path> FindProgramFolder(const Path& input) {
  std::vector<Path> found = FindNumberedFolders(input);
  if (!found.empty()) {
    return found;
  }
  for (const Path& folder : ListEntries(input)) {
    std::vector<Path> here = FindNumberedFolders(folder);
    if (!here.empty() && !found.empty()) {
      throw Error::File(ErrorCode::kMismatch,
                        input.string(),
                        "there are maps in " +
                            found[0].parent_path().filename().string() +
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

ExternalFiles FindFilesOf(const Path& folder, int number, MapType type) {
  ExternalFiles files;
  const Path geometric = FindGeometricDepth(folder);
  const Path plain = FindPlainDepth(folder);
  const bool take_geometric =
      !geometric.empty() && (type == MapType::kGeometric || plain.empty());
  files.depth = take_geometric ? geometric : plain;
  if (take_geometric || geometric.empty()) {
    files.normal = FindFile(folder, {"normals", "normal"});
  }
  char name[32];
  std::snprintf(name, sizeof(name), "%08d_cam.txt", number);
  for (const Path& cams : {folder.parent_path().parent_path() / "cams",
                           folder.parent_path() / "cams"}) {
    if (files.camera.empty() && HasMap(cams / name)) {
      files.camera = cams / name;
    }
  }
  return files;
}

void MatchNumberedFolders(const MatchOptions& options,
                          const SparseModel& model,
                          FilesOfImages* found) {
  const std::vector<int> order = OrderImages(options, model);
  for (const Path& folder : FindProgramFolder(options.input_path)) {
    const int number = *TrailingNumber(folder.filename().string());
    AddFiles(model,
             ImageOfNumber(order, number, folder),
             FindFilesOf(folder, number, options.type),
             found);
  }
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

// Returns the number of maps of images that are not in the model.
int MatchDmaps(const MatchOptions& options,
               const SparseModel& model,
               FilesOfImages* found) {
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
    const std::string stored =
        options.image_list.empty()
            ? ParseDmapImageName(ReadFileBytes(path, kMaxDmapNameEnd),
                                 path.string())
            : "";
    const int image = options.image_list.empty()
                          ? FindStoredName(model, stored, path)
                          : ImageOfNumber(order, *number, path);
    if (image >= 0) {
      ExternalFiles files;
      files.depth = path;
      AddFiles(model, image, std::move(files), found);
    } else {
      ++num_without_image;
      unknown = stored;
    }
  }
  if (found->empty()) {
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

std::string WithoutExtension(const std::string& name) {
  return Path(name).replace_extension().generic_string();
}

// The depth images or normals below a folder, by image. num_without_image: the
// number of files of images that are not in the model.
std::map<int, Path> FindNamedFiles(const MatchOptions& options,
                                   const SparseModel& model,
                                   const Path& folder,
                                   int* num_without_image) {
  const bool by_number = !options.image_list.empty();
  const std::vector<int> order = OrderImages(options, model);
  std::map<std::string, std::set<int>> images_of_key;
  for (const int image : order) {
    const std::string& name = model.images[image].name;
    images_of_key[name].insert(image);
    images_of_key[WithoutExtension(name)].insert(image);
  }
  std::map<int, Path> files;
  for (const TreeEntry& entry : ListTree({folder, {}})) {
    const Path path = entry.path;
    const std::optional<int> number = TrailingNumber(path.stem().string());
    const auto named = images_of_key.find(
        WithoutExtension(path.lexically_relative(folder).generic_string()));
    if (!IsDepthImageName(path)) {
      continue;
    }
    if (by_number ? !number : named == images_of_key.end()) {
      *num_without_image += entry.is_folder ? 0 : 1;
      continue;
    }
    if (!by_number && named->second.size() > 1) {
      throw Error::File(
          ErrorCode::kMismatch,
          path.string(),
          "may be for the image " + model.images[*named->second.begin()].name +
              " or for " + model.images[*named->second.rbegin()].name,
          "put the image's extension before the file's own");
    }
    const int image = by_number ? ImageOfNumber(order, *number, path)
                                : *named->second.begin();
    HasMap(path);
    const auto [other, is_new] = files.emplace(image, path);
    if (!is_new) {
      throw TwoMaps(std::max(path, other->second),
                    model.images[image].name,
                    std::min(path, other->second));
    }
  }
  return files;
}

// Returns the number of maps of images that are not in the model.
int MatchDepthImages(const MatchOptions& options,
                     const SparseModel& model,
                     FilesOfImages* found) {
  int num_without_image = 0;
  std::map<int, Path> normals;
  if (!options.normal_path.empty()) {
    RequireFolder(options.normal_path, OptionName("normal_path"));
    int ignored = 0;
    normals = FindNamedFiles(options, model, options.normal_path, &ignored);
  }
  for (const auto& [image, path] :
       FindNamedFiles(options, model, options.input_path, &num_without_image)) {
    ExternalFiles files;
    files.depth = path;
    if (const auto normal = normals.find(image); normal != normals.end()) {
      files.normal = normal->second;
    }
    AddFiles(model, image, std::move(files), found);
  }
  if (found->empty()) {
    throw Error::File(
        ErrorCode::kNotFound,
        options.input_path.string(),
        "no depth image (PNG, EXR, TIFF, PFM, NPY) in it is called as an image "
        "of the workspace, such as " +
            WithoutExtension(model.images[0].name) + ".png",
        "check " + OptionName("input_path") + ", or number the files and use " +
            OptionName("image_list"));
  }
  return num_without_image;
}

}  // namespace

MatchedMaps MatchImages(const MatchOptions& options, const SparseModel& model) {
  MatchOptions normal = options;
  normal.input_path = Normalized(options.input_path);
  RequireFolder(normal.input_path, OptionName("input_path"));
  FilesOfImages found;
  MatchedMaps matched;
  if (options.format == ExternalFormat::kOpenMvs) {
    matched.num_without_image = MatchDmaps(normal, model, &found);
  } else if (options.format == ExternalFormat::kDepth) {
    matched.num_without_image = MatchDepthImages(normal, model, &found);
  } else {
    MatchNumberedFolders(normal, model, &found);
  }
  for (const auto& [image, files] : found) {
    matched.files.push_back(files);
  }
  return matched;
}

std::vector<int> OrderImages(const MatchOptions& options,
                             const SparseModel& model) {
  std::vector<int> images;
  if (options.image_list.empty()) {
    images.resize(model.images.size());
    std::iota(images.begin(), images.end(), 0);
    return images;
  }
  std::set<int> seen;
  for (const ListedImage& listed :
       ReadImageList(options.image_list, model, OptionName("image_list"))) {
    if (!seen.insert(listed.image).second) {
      throw Error::File(ErrorCode::kMismatch,
                        options.image_list.string(),
                        "line " + std::to_string(listed.line) + " names " +
                            model.images[listed.image].name + " a second time",
                        "correct the line");
    }
    images.push_back(listed.image);
  }
  return images;
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
