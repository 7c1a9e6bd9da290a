// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/fusion_obstacles.h"

#include "colmap_tsar/base/median.h"

#include <algorithm>
#include <cstdio>
#include <limits>

namespace tsar {
namespace {

constexpr double kMaxRoundingPixels = 0.25;

// The coordinates of a point at the median depth of those that the image sees,
// rounded to single precision, in pixels.
double RoundingPixels(const SparseModel& model,
                      const SparseModel::ModelImage& image) {
  const Camera& camera = image.camera;
  const Eigen::Vector3d axis = camera.rotation.row(2).transpose();
  std::vector<double> depths;
  for (const int point : image.point_indices) {
    depths.push_back(axis.dot(model.points[static_cast<size_t>(point)]) +
                     camera.translation.z());
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

std::vector<std::string> FindFusionObstacles(
    const SparseModel& model, const std::filesystem::path& sparse_folder) {
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
    char numbers[128];
    std::snprintf(numbers,
                  sizeof(numbers),
                  "lies %.3g units from the origin, where the single precision "
                  "of stereo_fusion and of clouds is off by up to %.2g pixels",
                  farthest->camera.Center().norm(),
                  most);
    obstacles.push_back(sparse_folder.string() + ": the model " + numbers +
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
