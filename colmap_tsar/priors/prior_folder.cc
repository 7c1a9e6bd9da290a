// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/prior_folder.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/io/float_map.h"
#include "colmap_tsar/io/map_files.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <system_error>
#include <vector>

namespace tsar {
namespace {

using Path = std::filesystem::path;

std::string WithoutExtension(const std::string& name) {
  return Path(name).replace_extension().generic_string();
}

std::string Advice() { return "check " + OptionName("prior_path"); }

// The image and kind of a file in the folder.
struct Match {
  bool is_normals = false;
  int image = 0;

  auto operator<=>(const Match&) const = default;
};

// By the names of files in the folder, without their extensions.
using Matches = std::map<std::string, std::set<Match>>;

Matches MatchNames(const std::vector<std::string>& image_names) {
  Matches matches;
  for (size_t i = 0; i < image_names.size(); ++i) {
    const auto image = static_cast<int>(i);
    for (const std::string& name :
         {image_names[i], WithoutExtension(image_names[i])}) {
      matches[name].insert({false, image});
      matches[name + ".normal"].insert({true, image});
    }
  }
  return matches;
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

FloatMap ReadMap(const Path& path, bool is_normals, const RasterSize& photo) {
  const std::vector<uint8_t> bytes = ReadFileBytes(path);
  if (bytes.empty()) {
    throw Error::File(ErrorCode::kCorrupt,
                      path.string(),
                      "the file is empty",
                      "make the depth prior again");
  }
  FloatMap map = is_normals ? ParseNormalImage(bytes, path)
                            : ParseDepthImage(bytes, path).map;
  if (!is_normals && map.channels != 1) {
    throw Error::File(
        ErrorCode::kUnsupported,
        path.string(),
        "has " + std::to_string(map.channels) + " channels, not one of depth",
        "save depth alone; normals have names that end in .normal" +
            path.extension().string());
  }
  if (const RasterSize size = {map.width, map.height};
      !FitsPhoto(size, photo)) {
    throw Error::File(
        ErrorCode::kMismatch,
        path.string(),
        "the depth prior has " + ToString(size) +
            " pixels, which is not the shape of its undistorted image of " +
            ToString(photo),
        "make it of the image in the workspace's folder images");
  }
  return map;
}

// Adds a constant to values that are known up to one, as negative ones
// indicate, unless they are few or one number that stands for "none".
void MakePositive(std::vector<float>* values) {
  constexpr int64_t kMinShare = 20;  // One of so many.
  float least = 0.f;
  float most = 0.f;
  for (const float value : *values) {
    least = std::isfinite(value) ? std::min(least, value) : least;
    most = std::isfinite(value) ? std::max(most, value) : most;
  }
  const int64_t num_negative = std::ranges::count_if(
      *values, [&](float value) { return value < 0.f && value > least; });
  if (num_negative * kMinShare > static_cast<int64_t>(values->size())) {
    for (float& value : *values) {
      value =
          std::isfinite(value) ? value - least + 0.01f * (most - least) : 0.f;
    }
  }
}

template <typename T>
Image<T> Reduce(const Image<T>& image) {
  const int side = std::max(image.Width(), image.Height());
  auto reduced = Image<T>::Uninitialized(
      ReducedLength(image.Width(), side, kMaxPriorSide),
      ReducedLength(image.Height(), side, kMaxPriorSide));
  for (int y = 0; y < reduced.Height(); ++y) {
    const int row = NearestPixel(y, image.Height(), reduced.Height());
    for (int x = 0; x < reduced.Width(); ++x) {
      reduced(x, y) =
          image(NearestPixel(x, image.Width(), reduced.Width()), row);
    }
  }
  return reduced;
}

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
  const Matches matches = MatchNames(image_names);
  std::set<Path> paths;
  for (const FolderEntry& entry : ListTree({folder, {}})) {
    if (IsDepthImageName(entry.path)) {
      paths.insert(entry.path);
    }
  }
  for (const Path& path : paths) {
    const auto found = matches.find(
        WithoutExtension(path.lexically_relative(folder).generic_string()));
    if (found == matches.end()) {
      // Folders may have such names as well.
      if (IsFile(path)) {
        stray_files_.push_back(path);
      }
      continue;
    }
    const Match match = *found->second.begin();
    if (found->second.size() > 1) {
      throw Error::File(ErrorCode::kMismatch,
                        path.string(),
                        "may be of the image " + image_names[match.image] +
                            " or of " +
                            image_names[found->second.rbegin()->image],
                        "put the image's extension before the file's own");
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
  }
  if (std::ranges::all_of(files_, &PriorFiles::Empty)) {
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

DepthPrior ReadPrior(const PriorFiles& files,
                     PriorType type,
                     const RasterSize& photo) {
  DepthPrior prior;
  prior.type = type;
  if (!files.depth.empty()) {
    FloatMap map = ReadMap(files.depth, false, photo);
    if (type != PriorType::kMetric) {
      MakePositive(&map.values);
    }
    prior.values = Reduce(ToDepth(map, files.depth.string()));
  }
  if (!files.normals.empty()) {
    prior.normals = Reduce(
        ToNormals(ReadMap(files.normals, true, photo), files.normals.string()));
    for (Vec3f& normal : prior.normals) {
      normal = std::isfinite(Norm(normal)) ? Normalized(normal) : Vec3f{};
    }
  }
  return prior;
}

}  // namespace tsar
