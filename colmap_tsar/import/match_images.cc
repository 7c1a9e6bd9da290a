// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/match_images.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/import/byte_reader.h"
#include "colmap_tsar/import/depth_image.h"
#include "colmap_tsar/import/dmap.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <fstream>
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

std::vector<Path> ListEntries(const Path& folder) {
  std::vector<Path> entries;
  std::error_code error;
  for (std::filesystem::directory_iterator it(folder, error), end;
       !error && it != end;
       it.increment(error)) {
    entries.push_back(it->path());
  }
  // The order of a folder's entries is the file system's.
  std::sort(entries.begin(), entries.end());
  return entries;
}

bool IsFolder(const Path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error);
}

bool IsFile(const Path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error);
}

void RequireFolder(const Path& folder, const char* option) {
  if (!IsFolder(folder)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "no such folder",
                      std::string("check ") + option);
  }
}

// Without "." and a slash at the end, so that it has a folder above.
Path Normalized(const Path& path) {
  const Path normal = std::filesystem::absolute(path).lexically_normal();
  return normal.has_filename() ? normal : normal.parent_path();
}

// The number that a name ends in.
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

std::string WithoutExtension(const std::string& name) {
  return Path(name).replace_extension().generic_string();
}

std::string Trimmed(const std::string& text) {
  constexpr const char* kBlank = " \t\r\n\v\f";
  const size_t first = text.find_first_not_of(kBlank);
  return first == std::string::npos
             ? ""
             : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// The images by their numbers, from a file.
std::vector<int> ReadImageList(const Path& path, const SparseModel& model) {
  std::ifstream file(path);
  if (!file || !IsFile(path)) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "the list of images is missing or cannot be read",
                      "check --image_list");
  }
  std::vector<int> images;
  std::set<int> seen;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    const std::string name = Trimmed(line);
    if (name.empty()) {
      continue;
    }
    const int image = model.IndexOf(name);
    if (image < 0 || !seen.insert(image).second) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "line " + std::to_string(number) + " names " + name +
                            (image < 0 ? ", which is not in the sparse model"
                                       : " a second time"),
                        "correct the line");
    }
    images.push_back(image);
  }
  if (images.empty()) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "the list names no image",
                      "write one image name per line");
  }
  return images;
}

std::vector<int> OrderImages(const MatchOptions& options,
                             const SparseModel& model) {
  if (!options.image_list.empty()) {
    return ReadImageList(options.image_list, model);
  }
  std::vector<int> images(model.images.size());
  std::iota(images.begin(), images.end(), 0);
  if (options.index_order == IndexOrder::kName) {
    std::sort(images.begin(), images.end(), [&](int a, int b) {
      return model.images[static_cast<size_t>(a)].name <
             model.images[static_cast<size_t>(b)].name;
    });
  }
  return images;
}

int ImageOfNumber(const std::vector<int>& order, int number, const Path& path) {
  if (static_cast<size_t>(number) >= order.size()) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "its number is " + std::to_string(number) +
                          ", but there are images 0 to " +
                          std::to_string(order.size() - 1) + " alone",
                      "name the images in their order with --image_list");
  }
  return order[static_cast<size_t>(number)];
}

// The first of the files that exists, with one of the extensions.
Path FindFile(const Path& folder, std::initializer_list<const char*> names) {
  for (const char* name : names) {
    for (const char* extension : {".dmb", ".bin"}) {
      Path path = folder / (std::string(name) + extension);
      if (IsFile(path)) {
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

// In the folder itself, or in the one of its folders that has such.
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
                        "give one of the two as --input_path");
    }
    found = std::move(here);
    chosen = folder;
  }
  if (found.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      input.string(),
                      "no folder in it is called like 2333_00000000 and holds "
                      "depths.dmb",
                      "check --input_path and --format");
  }
  return found;
}

PriorFiles FindFilesOf(const NumberedFolder& folder,
                       const MatchOptions& options) {
  PriorFiles files;
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
    if (files.camera.empty() && IsFile(cams / name)) {
      files.camera = cams / name;
    }
  }
  return files;
}

// Collects the files of all images; each image may come once.
class Collector {
 public:
  explicit Collector(const SparseModel& model) : model_(model) {}

  void Add(int image, PriorFiles files) {
    files.image = image;
    const auto [entry, is_new] = files_.emplace(image, files);
    if (!is_new) {
      throw Error::File(
          ErrorCode::kMismatch,
          files.depth.string(),
          "is for the image " + model_.images[static_cast<size_t>(image)].name +
              ", and so is " + entry->second.depth.string(),
          "take one of the two away, or name the images in their order with "
          "--image_list");
    }
  }

  std::map<int, PriorFiles>& Files() { return files_; }

 private:
  const SparseModel& model_;
  std::map<int, PriorFiles> files_;
};

// -1 where no image fits.
int FindStoredName(const SparseModel& model,
                   std::string stored,
                   const Path& path) {
  std::replace(stored.begin(), stored.end(), '\\', '/');
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
                          model.images[static_cast<size_t>(same_stem[0])].name +
                          " or " +
                          model.images[static_cast<size_t>(same_stem[1])].name,
                      "name the images in their order with --image_list");
  }
  return same_stem[0];
}

int MatchOpenMvs(const MatchOptions& options,
                 const SparseModel& model,
                 Collector* collector) {
  const bool by_number = !options.image_list.empty();
  const std::vector<int> order = OrderImages(options, model);
  int num_without_image = 0;
  std::string unknown;
  for (const Path& path : ListEntries(options.input_path)) {
    const std::string stem = path.stem().string();
    const std::optional<int> number = TrailingNumber(stem);
    // Others, such as depth0012.geo.dmap, are of passes before the last.
    if (path.extension() != ".dmap" || !number || !stem.starts_with("depth")) {
      continue;
    }
    PriorFiles files;
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
    throw Error::File(ErrorCode::kNotFound,
                      options.input_path.string(),
                      num_without_image == 0
                          ? "no file in it is called like depth0000.dmap"
                          : "its maps are for images such as " + unknown +
                                ", which are not in the sparse model",
                      num_without_image == 0
                          ? "check --input_path"
                          : "name the images in their order with --image_list");
  }
  return num_without_image;
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
        ++num_without_image_;
        continue;
      }
      const auto [entry, is_new] = files.emplace(image, path);
      if (!is_new) {
        throw Error::File(ErrorCode::kMismatch,
                          path.string(),
                          "is for the image " +
                              model_.images[static_cast<size_t>(image)].name +
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
    std::error_code error;
    for (std::filesystem::recursive_directory_iterator it(folder, error), end;
         !error && it != end;
         it.increment(error)) {
      if (IsFile(it->path()) && IsDepthImageName(it->path())) {
        files.push_back(it->path());
      }
    }
    std::sort(files.begin(), files.end());
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

int MatchDepthImages(const MatchOptions& options,
                     const SparseModel& model,
                     Collector* collector) {
  NamedFiles named(options, model);
  std::map<int, Path> normals;
  if (!options.normal_path.empty()) {
    RequireFolder(options.normal_path, "--normal_path");
    normals = named.Find(options.normal_path);
  }
  for (const auto& [image, path] : named.Find(options.input_path)) {
    PriorFiles files;
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
        "check --input_path, or number the files and use --image_list");
  }
  return named.NumWithoutImage();
}

}  // namespace

MatchedMaps MatchImages(const MatchOptions& options, const SparseModel& model) {
  MatchOptions normal = options;
  normal.input_path = Normalized(options.input_path);
  RequireFolder(normal.input_path, "--input_path");
  Collector collector(model);
  MatchedMaps matched;
  if (options.format == PriorFormat::kOpenMvs) {
    matched.num_without_image = MatchOpenMvs(normal, model, &collector);
  } else if (options.format == PriorFormat::kDepth) {
    matched.num_without_image = MatchDepthImages(normal, model, &collector);
  } else {
    const std::vector<int> order = OrderImages(options, model);
    for (const NumberedFolder& folder : FindProgramFolder(normal.input_path)) {
      collector.Add(ImageOfNumber(order, folder.number, folder.path),
                    FindFilesOf(folder, options));
    }
  }
  for (auto& [image, files] : collector.Files()) {
    matched.files.push_back(std::move(files));
  }
  return matched;
}

}  // namespace tsar
