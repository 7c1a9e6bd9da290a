// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/export/image_maps.h"

#include "colmap_tsar/base/path.h"
#include "colmap_tsar/compose/confidence_level.h"
#include "colmap_tsar/io/gray_png.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/io/sigma_map.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

namespace tsar {
namespace {

uint16_t ToLevel(double value) {
  return static_cast<uint16_t>(std::lround(value));
}

// Reads the map in a file; empty if there is no such file.
template <typename Read>
auto ReadIfThere(const Image<float>& depth,
                 const std::filesystem::path& path,
                 Read read) {
  return Exists(path) ? RequireSizeOf(depth, "the depth map", path, read(path))
                      : decltype(read(path))();
}

Image<uint8_t> MaskOf(const Workspace& workspace,
                      int image,
                      const Image<float>& depth) {
  return workspace.ReadMask(image, {depth.Width(), depth.Height()});
}

// Reads a depth map including masked pixels.
Image<float> ReadWholeDepth(const Workspace& workspace, int image) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const SparseModel::ModelImage& model_image =
      workspace.Model().images.at(static_cast<size_t>(image));
  Image<float> depth = ReadDepthMap(paths.depth);
  RequireShape(paths.depth,
               {depth.Width(), depth.Height()},
               {model_image.camera.width, model_image.camera.height},
               "the image " + model_image.name,
               "run patch_match_stereo again for this image");
  return depth;
}

// Reads a normal map including masked pixels.
Image<Vec3f> ReadWholeNormal(const Workspace& workspace,
                             int image,
                             const Image<float>& depth) {
  const ContainedPath path = workspace.Paths(image, workspace.Type()).normal;
  return RequireSizeOf(depth, "the depth map", path, ReadNormalMap(path));
}

float Median(std::vector<float>* values) {
  const auto middle =
      values->begin() + static_cast<std::ptrdiff_t>((values->size() - 1) / 2);
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

}  // namespace

Image<uint16_t> DepthLevels(const Image<float>& depth,
                            double step,
                            int64_t* num_out_of_range) {
  Image<uint16_t> levels(depth.Width(), depth.Height());
  std::transform(
      depth.begin(), depth.end(), levels.begin(), [&](float z) -> uint16_t {
        const double level = z / step;
        if (level >= 0.5 && level < kMaxLevel + 0.5) {
          return ToLevel(level);
        }
        *num_out_of_range += z > 0.f ? 1 : 0;
        return 0;
      });
  return levels;
}

Image<uint16_t> SigmaLevels(const Image<float>& sigma, double step) {
  Image<uint16_t> levels(sigma.Width(), sigma.Height());
  std::transform(
      sigma.begin(), sigma.end(), levels.begin(), [&](float s) -> uint16_t {
        return s > 0.f ? ToLevel(std::clamp(s / step, 1.0, 1.0 * kMaxLevel))
                       : 0;
      });
  return levels;
}

Image<Rgb16> NormalLevels(const Image<Vec3f>& normal) {
  const auto to_level = [](float value) {
    const double bounded = std::clamp(value, -1.f, 1.f);
    return ToLevel((bounded - kNormalOffset) / kNormalScale);
  };
  Image<Rgb16> levels(normal.Width(), normal.Height());
  std::transform(
      normal.begin(), normal.end(), levels.begin(), [&](const Vec3f& n) {
        return Rgb16{to_level(n.x), to_level(n.y), to_level(n.z)};
      });
  return levels;
}

Image<float> ConfidencesOf(const Image<uint8_t>& levels) {
  Image<float> confidences(levels.Width(), levels.Height());
  std::transform(
      levels.begin(), levels.end(), confidences.begin(), &ConfidenceOfLevel);
  return confidences;
}

double StepFor(double depth) {
  const double exact = depth / kMaxLevel;
  const double digit = std::pow(10.0, std::floor(std::log10(exact)));
  return digit * std::ceil(exact / digit);
}

std::vector<int> FindImagesWithMaps(const Workspace& workspace) {
  std::vector<int> images;
  const int num_images = static_cast<int>(workspace.Model().images.size());
  for (int image = 0; image < num_images; ++image) {
    const MapPaths paths = workspace.Paths(image, workspace.Type());
    if (Exists(paths.depth) && Exists(paths.normal)) {
      images.push_back(image);
    }
  }
  return images;
}

Image<float> ReadImageDepth(const Workspace& workspace, int image) {
  Image<float> depth = ReadWholeDepth(workspace, image);
  ClearMasked(MaskOf(workspace, image, depth), &depth);
  return depth;
}

Image<Vec3f> ReadImageNormal(const Workspace& workspace,
                             int image,
                             const Image<float>& depth) {
  Image<Vec3f> normal = ReadWholeNormal(workspace, image, depth);
  ClearMasked(MaskOf(workspace, image, depth), &normal);
  return normal;
}

ImageMaps ReadImageMaps(const Workspace& workspace, int image) {
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  ImageMaps maps;
  maps.depth = ReadWholeDepth(workspace, image);
  maps.normal = ReadWholeNormal(workspace, image, maps.depth);
  maps.confidence = ReadIfThere(maps.depth, paths.confidence, &ReadGrayPng);
  maps.sigma = ReadIfThere(maps.depth, paths.sigma, &ReadSigmaMap);
  maps.provenance = ReadIfThere(maps.depth, paths.provenance, &ReadGrayPng);
  maps.planes = ReadIfThere(maps.depth, paths.planes, &ReadGray16Png);
  const Image<uint8_t> mask = MaskOf(workspace, image, maps.depth);
  ClearMasked(mask, &maps.depth);
  ClearMasked(mask, &maps.normal);
  ClearMasked(mask, &maps.confidence);
  ClearMasked(mask, &maps.sigma);
  ClearMasked(mask, &maps.provenance);
  ClearMasked(mask, &maps.planes);
  return maps;
}

ImageMaps ReadOriginalImageMaps(const Workspace& workspace, int image) {
  DepthNormal original = workspace.ReadOriginalMaps(image, workspace.Type());
  ImageMaps maps;
  maps.depth = std::move(original.depth);
  maps.normal = std::move(original.normal);
  const Image<uint8_t> mask = MaskOf(workspace, image, maps.depth);
  ClearMasked(mask, &maps.depth);
  ClearMasked(mask, &maps.normal);
  return maps;
}

DepthStatistics MeasureDepth(const Image<float>& depth) {
  std::vector<float> depths;
  depths.reserve(depth.NumPixels());
  std::copy_if(
      depth.begin(), depth.end(), std::back_inserter(depths), [](float z) {
        return z > 0.f;
      });
  DepthStatistics statistics;
  if (!depths.empty()) {
    const auto [nearest, farthest] =
        std::minmax_element(depths.begin(), depths.end());
    statistics = {static_cast<int64_t>(depths.size()), *nearest, *farthest};
    statistics.median = Median(&depths);
  }
  return statistics;
}

DepthStatistics JoinStatistics(const std::vector<DepthStatistics>& maps) {
  DepthStatistics joined;
  std::vector<float> medians;
  for (const DepthStatistics& map : maps) {
    if (map.num_depths > 0) {
      joined.nearest = joined.num_depths > 0
                           ? std::min(joined.nearest, map.nearest)
                           : map.nearest;
      joined.farthest = std::max(joined.farthest, map.farthest);
      joined.num_depths += map.num_depths;
      medians.push_back(map.median);
    }
  }
  if (!medians.empty()) {
    joined.median = Median(&medians);
  }
  return joined;
}

}  // namespace tsar
