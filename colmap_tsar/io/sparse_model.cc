// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/sparse_model.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/median.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/text_stream.h"

#include <algorithm>
#include <limits>

namespace tsar {
namespace {

using Path = std::filesystem::path;

// Whether a folder holds any of the files of a sparse model.
bool HoldsModel(const Path& folder) {
  for (const std::string extension : {".bin", ".txt"}) {
    for (const char* name : {"cameras", "images", "points3D"}) {
      if (Exists(folder / (name + extension))) {
        return true;
      }
    }
  }
  return false;
}

// Every path of an image is derived from its name, so a name must not leave the
// workspace.
void RequireSafeName(const Path& folder, const std::string& name) {
  const Path path(name);
  if (path.is_absolute() ||
      std::find(path.begin(), path.end(), "..") != path.end()) {
    throw Error::File(ErrorCode::kUnsupported,
                      folder.string(),
                      "the image name " + name + " leads out of the workspace",
                      "rename the image and make the workspace again");
  }
}

// The coordinates of a point at the median depth of those that the image sees,
// rounded to single precision, in pixels.
double RoundingPixels(const SparseModel& model,
                      const SparseModel::ModelImage& image) {
  const Camera& camera = image.camera;
  const Eigen::Vector3d axis = camera.rotation.row(2).transpose();
  std::vector<double> depths;
  for (const int point : image.point_indices) {
    depths.push_back(axis.dot(model.points[point]) + camera.translation.z());
  }
  if (depths.empty()) {
    return 0.0;
  }
  const double depth = UpperMedian(&depths);
  const double rounding = 0.5 * std::numeric_limits<float>::epsilon() *
                          camera.Center().lpNorm<Eigen::Infinity>();
  return depth > 0.0 ? rounding * camera.fx / depth : 0.0;
}

}  // namespace

const SparseModel::ModelImage* SparseModel::Find(
    const std::string& name) const {
  const int index = IndexOf(name);
  return index < 0 ? nullptr : &images[index];
}

int SparseModel::IndexOf(const std::string& name) const {
  const auto entry = index_of_name_.find(name);
  return entry == index_of_name_.end() ? -1 : entry->second;
}

void SparseModel::IndexNames() {
  index_of_name_.clear();
  for (size_t i = 0; i < images.size(); ++i) {
    index_of_name_.emplace(images[i].name, static_cast<int>(i));
  }
}

std::array<Path, 3> FindSparseModelFiles(const Path& sparse_folder) {
  for (const std::string extension : {".bin", ".txt"}) {
    const std::array<Path, 3> paths = {
        sparse_folder / ("cameras" + extension),
        sparse_folder / ("images" + extension),
        sparse_folder / ("points3D" + extension)};
    if (std::ranges::all_of(paths, &Exists)) {
      return paths;
    }
  }
  throw Error::File(
      ErrorCode::kNotFound,
      sparse_folder.string(),
      "the sparse model is not complete: neither cameras, images and points3D "
      ".bin nor .txt are all there",
      "copy it again, or make the workspace with image_undistorter");
}

Path FindModelFolder(const Path& root) {
  const Path sparse = root / "sparse";
  for (const Path& folder : {sparse, sparse / "0"}) {
    if (HoldsModel(folder)) {
      return folder;
    }
  }
  throw Error::File(ErrorCode::kNotFound,
                    sparse.string(),
                    "no sparse model: cameras, images and points3D, .bin or "
                    ".txt, are neither there nor in its folder 0",
                    "make the workspace with image_undistorter");
}

SparseModel ReadWorkspaceModel(const Path& model_folder) {
  SparseModel model = ReadSparseModel(model_folder);
  for (const SparseModel::ModelImage& image : model.images) {
    RequireSafeName(model_folder, image.name);
  }
  return model;
}

std::vector<std::string> FindFusionObstacles(const SparseModel& model,
                                             const Path& sparse_folder) {
  constexpr double kMaxRoundingPixels = 0.25;
  std::vector<std::string> obstacles;
  const SparseModel::ModelImage* farthest = nullptr;
  double most = 0.0;
  for (const SparseModel::ModelImage& image : model.images) {
    const double pixels = RoundingPixels(model, image);
    if (pixels > most) {
      most = pixels;
      farthest = &image;
    }
  }
  if (most > kMaxRoundingPixels) {
    obstacles.push_back(
        sparse_folder.string() +
        Formatted(": the model "
                  "lies %.3g units from the origin, where the single precision "
                  "of stereo_fusion and of clouds is off by up to %.2g pixels",
                  farthest->camera.Center().norm(),
                  most) +
        "; before fusion shift it by colmap model_transformer "
        "(docs/troubleshooting.md tells how; the maps stay as "
        "they are)");
  }
  const bool is_text =
      FindSparseModelFiles(sparse_folder)[1].extension() == ".txt";
  const auto spaced = std::ranges::find_if(model.images, [](const auto& image) {
    return image.name.find(' ') != std::string::npos;
  });
  if (is_text && spaced != model.images.end()) {
    obstacles.push_back(
        sparse_folder.string() + ": the image \"" + spaced->name +
        "\" has a space in its name, which COLMAP does not read in text models "
        "(stereo_fusion would not find its maps); use tsar_fuse, rename the "
        "images, or write the model as cameras.bin, images.bin and "
        "points3D.bin");
  }
  return obstacles;
}

}  // namespace tsar
