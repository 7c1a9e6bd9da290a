// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/prior_folder.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/float_map.h"
#include "colmap_tsar/io/map_files.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace tsar {
namespace {

using Path = std::filesystem::path;

constexpr std::string_view kNormalSuffix = ".normal";

std::string WithoutExtension(const std::string& name) {
  return Path(name).replace_extension().generic_string();
}

std::string Advice() { return "check " + OptionName("prior_path"); }

// The image and kind of a file in the folder.
struct Match {
  int image = -1;
  bool is_normals = false;
};

class NameMatcher {
 public:
  explicit NameMatcher(const std::vector<std::string>& names) : names_(names) {
    for (size_t i = 0; i < names.size(); ++i) {
      images_of_[names[i]].insert(static_cast<int>(i));
      images_of_[WithoutExtension(names[i])].insert(static_cast<int>(i));
    }
  }

  // path: the file; name: its path in the folder. No image if none matches.
  Match Find(const Path& path, const std::string& name) const {
    const std::string stem = WithoutExtension(name);
    std::vector<Match> matches;
    AddMatches(stem, false, &matches);
    if (stem.ends_with(kNormalSuffix)) {
      AddMatches(
          stem.substr(0, stem.size() - kNormalSuffix.size()), true, &matches);
    }
    if (matches.size() > 1) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "may be of the image " + Name(matches[0]) + " or of " +
                            Name(matches[1]),
                        "put the image's extension before the file's own");
    }
    return matches.empty() ? Match() : matches.front();
  }

 private:
  void AddMatches(const std::string& key,
                  bool is_normals,
                  std::vector<Match>* matches) const {
    const auto found = images_of_.find(key);
    if (found != images_of_.end()) {
      for (const int image : found->second) {
        matches->push_back({image, is_normals});
      }
    }
  }

  const std::string& Name(const Match& match) const {
    return names_[match.image];
  }

  const std::vector<std::string>& names_;
  std::map<std::string, std::set<int>> images_of_;
};

// The depth images of a folder, in the order of their names.
std::vector<Path> ListDepthImages(const Path& folder) {
  std::vector<Path> files;
  for (const TreeEntry& entry : ListTree({folder, {}})) {
    if (IsDepthImageName(entry.path)) {
      files.push_back(entry.path);
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

Error NoPriors(const Path& folder, const std::vector<std::string>& names) {
  std::string example;
  if (!names.empty()) {
    const std::string& name = names.front();
    const std::string stem = WithoutExtension(name);
    example = "; depth of " + name + " would be " + name + ".npy or " + stem +
              ".npy, its normals " + name + ".normal.npy or " + stem +
              ".normal.npy (or .exr, .pfm, .png, .tif, .tiff)";
  }
  return Error::File(ErrorCode::kNotFound,
                     folder.string(),
                     "holds no depth prior of any image" + example,
                     Advice());
}

namespace fs = std::filesystem;

bool FitsPhoto(const RasterSize& size, const RasterSize& photo) {
  constexpr double kMaxRatio = 1.02;
  const double width = size.height / static_cast<double>(photo.height) *
                       static_cast<double>(photo.width);
  const double height = size.width / static_cast<double>(photo.width) *
                        static_cast<double>(photo.height);
  return std::max(width / size.width, size.width / width) <= kMaxRatio ||
         std::abs(width - size.width) <= 1.0 ||
         std::abs(height - size.height) <= 1.0;
}

void RequireFit(const fs::path& path,
                const FloatMap& map,
                const RasterSize& photo) {
  const RasterSize size = {map.width, map.height};
  if (!FitsPhoto(size, photo)) {
    throw Error::File(
        ErrorCode::kMismatch,
        path.string(),
        "the depth prior has " + ToString(size) +
            " pixels, which is not the shape of its undistorted image of " +
            ToString(photo),
        "make it of the image in the workspace's folder images");
  }
}

// value_of: maps the channels of a pixel to its value.
template <typename T, typename ValueOf>
Image<T> ReduceMap(const FloatMap& map, const ValueOf& value_of) {
  const int side = std::max(map.width, map.height);
  auto image =
      Image<T>::Uninitialized(ReducedLength(map.width, side, kMaxPriorSide),
                              ReducedLength(map.height, side, kMaxPriorSide));
  for (int y = 0; y < image.Height(); ++y) {
    const int64_t row =
        int64_t{NearestPixel(y, map.height, image.Height())} * map.width;
    for (int x = 0; x < image.Width(); ++x) {
      const int64_t pixel = row + NearestPixel(x, map.width, image.Width());
      image(x, y) = value_of(map.values.data() + pixel * map.channels);
    }
  }
  return image;
}

float ToValue(const float* channel) {
  return std::isfinite(*channel) && *channel > 0.f ? *channel : 0.f;
}

Vec3f ToNormal(const float* channels) {
  const Vec3f normal = {channels[0], channels[1], channels[2]};
  return std::isfinite(Norm(normal)) ? Normalized(normal) : Vec3f{};
}

class PriorReader {
 public:
  explicit PriorReader(const RasterSize& photo) : photo_(photo) {}

  DepthPrior Read(const PriorFiles& files) {
    DepthPrior prior;
    if (!files.depth.empty()) {
      prior.values = ReduceMap<float>(ReadDepth(files.depth), &ToValue);
    }
    if (!files.normals.empty()) {
      prior.normals = ReduceMap<Vec3f>(
          ReadMap(files.normals, &ParseNormalImage), &ToNormal);
    }
    return prior;
  }

 private:
  FloatMap ReadDepth(const fs::path& path) {
    FloatMap map =
        ReadMap(path, [](std::span<const uint8_t> bytes, const fs::path& file) {
          return ParseDepthImage(bytes, file).map;
        });
    if (map.channels != 1) {
      throw Error::File(
          ErrorCode::kUnsupported,
          path.string(),
          "has " + std::to_string(map.channels) + " channels, not one of depth",
          "save depth alone; normals have names that end in .normal" +
              path.extension().string());
    }
    return map;
  }

  template <typename Parse>
  FloatMap ReadMap(const fs::path& path, const Parse& parse) {
    const std::vector<uint8_t> bytes = ReadFileBytes(path);
    if (bytes.empty()) {
      throw Error::File(ErrorCode::kCorrupt,
                        path.string(),
                        "the file is empty",
                        "make the depth prior again");
    }
    FloatMap map = parse(bytes, path);
    RequireFit(path, map, photo_);
    return map;
  }

  const RasterSize photo_;
};

}  // namespace

void RequirePathOfPriorType(const Path& folder, PriorType type) {
  if (folder.empty() && type != PriorType::kAuto) {
    throw Error(ErrorCode::kBadOption,
                OptionName("prior_type") +
                    " says what depth priors mean; give " +
                    OptionName("prior_path") + " as well");
  }
}

PriorFolder::PriorFolder(const Path& folder,
                         PriorType type,
                         const std::vector<std::string>& image_names)
    : folder_(folder), type_(type), files_(image_names.size()) {
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "there is no such folder of depth priors",
                      Advice());
  }
  const NameMatcher matcher(image_names);
  bool has_any = false;
  for (const Path& path : ListDepthImages(folder)) {
    const Match match =
        matcher.Find(path, path.lexically_relative(folder).generic_string());
    if (match.image < 0) {
      // Folders may have such names as well.
      if (IsFile(path) && num_stray_files_++ == 0) {
        first_stray_file_ = path;
      }
      continue;
    }
    PriorFiles& files = files_[match.image];
    Path& place = match.is_normals ? files.normals : files.depth;
    if (!place.empty()) {
      throw Error::File(
          ErrorCode::kMismatch,
          path.string(),
          std::string(match.is_normals ? "are normals" : "is depth") +
              " of the image " + image_names[match.image] + ", and so " +
              (match.is_normals ? "are those in " : "is ") + place.string(),
          "take one of the two away");
    }
    place = path;
    has_any = true;
  }
  if (!has_any) {
    throw NoPriors(folder, image_names);
  }
}

const PriorFiles& PriorFolder::FilesOf(int image) const {
  static const PriorFiles none;
  return files_.empty() ? none : files_.at(static_cast<size_t>(image));
}

std::optional<int64_t> PriorFolder::Count(
    const std::vector<int>& images) const {
  if (files_.empty()) {
    return std::nullopt;
  }
  return std::count_if(
      images.begin(), images.end(), [&](int image) { return HasPrior(image); });
}

void PriorFolder::WarnOfStrayFiles() const {
  if (num_stray_files_ > 0) {
    Warn(folder_.string() + ": " + std::to_string(num_stray_files_) +
         (num_stray_files_ == 1 ? " file belongs to no image, such as "
                                : " files belong to no image, such as ") +
         first_stray_file_.string());
  }
}

DepthPrior ReadPrior(const PriorFiles& files,
                     PriorType type,
                     const RasterSize& photo) {
  DepthPrior prior = PriorReader(photo).Read(files);
  prior.type = type;
  return prior;
}

}  // namespace tsar
