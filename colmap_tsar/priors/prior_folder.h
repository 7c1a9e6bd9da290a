// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/priors/depth_prior.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// The files of one image's prior. Either may be empty: there is none.
struct PriorFiles {
  std::filesystem::path depth;
  std::filesystem::path normals;

  bool Empty() const { return depth.empty() && normals.empty(); }
};

// A prior describes walls and floors, not details: its rasters are kept at this
// longer side at most, so that they take little memory compared to the maps.
constexpr int kMaxPriorSide = 1024;

// Reads the files of an image whose undistorted photo has this size, by
// ParseDepthImage() and ParseNormalImage(). Larger rasters are reduced by
// taking the nearest pixel. Values that are not finite become 0, and so do
// negative ones, unless they are many and the type is not kMetric: then all get
// a constant that makes them positive. Normals become unit vectors or (0, 0,
// 0).
//
// Throws Error, naming the file: kNotFound (no such file), kIo (it cannot be
// read, or is a folder), kCorrupt, kUnsupported (such as depth of 8 bits),
// kMismatch (its aspect ratio differs from the photo's by more than 2 % and by
// more than one of its pixels).
DepthPrior ReadPrior(const PriorFiles& files,
                     PriorType type,
                     const RasterSize& photo);

// Throws Error kBadOption, naming the options prior_type and prior_path, for a
// type without a folder.
void RequirePathOfPriorType(const std::filesystem::path& folder,
                            PriorType type);

// A folder with the depth priors of images, which are given by their indices in
// a list of names. The depth of the image sub/a.jpg is sub/a.jpg.EXT or
// sub/a.EXT in the folder, its normals are sub/a.jpg.normal.EXT or
// sub/a.normal.EXT, where EXT is one of the extensions of IsDepthImageName().
// An image may have depth, normals, both or none.
class PriorFolder {
 public:
  // Without a folder, no image has a prior.
  PriorFolder() = default;
  // Throws Error: kNotFound (there is no such folder, or it holds no prior of
  // any of the images; names the option prior_path), kMismatch (an image has
  // two files of the same kind, or a file matches two images), kIo.
  PriorFolder(const std::filesystem::path& folder,
              PriorType type,
              const std::vector<std::string>& image_names);

  bool HasPrior(int image) const { return !FilesOf(image).Empty(); }
  const PriorFiles& FilesOf(int image) const;
  // The meaning of the values of all depth files.
  PriorType Type() const { return type_; }

  // The number of the images that have a prior; nothing without a folder.
  std::optional<int64_t> Count(const std::vector<int>& images) const;

  // Warns of files that match no image, with their number and one of them.
  void WarnOfStrayFiles() const {
    tsar::WarnOfStrayFiles(folder_, stray_files_);
  }

 private:
  std::filesystem::path folder_;
  PriorType type_ = PriorType::kAuto;
  std::vector<PriorFiles> files_;  // By image; empty: no folder.
  std::vector<std::filesystem::path> stray_files_;
};

}  // namespace tsar
