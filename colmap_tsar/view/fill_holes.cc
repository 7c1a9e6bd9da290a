// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/fill_holes.h"

#include "colmap_tsar/view/superpixels/correlation.h"

namespace tsar {
namespace {

bool HasFilter(const RefineOptions& options) {
  return options.refine && options.weighted_median;
}

WeightedMedianOptions FilterOptions(const RefineOptions& options,
                                    int width,
                                    int height) {
  WeightedMedianOptions filter;
  filter.radius = ScaledRadius(2.f * options.window_radius, width, height);
  filter.spatial_sigma = static_cast<float>(options.spatial_sigma);
  filter.color_sigma = static_cast<float>(options.color_sigma);
  filter.min_support = options.fill_wide_holes ? 0.f : 1.f / 3.f;
  if (options.pixel_distances) {
    filter.distance_unit = ScaledRadius(1.f, width, height);
  }
  return filter;
}

// The cosine with the ray of normals that are tilted to the camera: that of a
// plane that the ray still meets.
constexpr float kGrazing = -1e-3f;

// To negate such a normal would turn its surface over.
void FaceCamera(const Intrinsics& intrinsics, Image<Vec3f>* normals) {
  for (int y = 0; y < normals->Height(); ++y) {
    for (int x = 0; x < normals->Width(); ++x) {
      Vec3f& normal = (*normals)(x, y);
      const Vec3f ray =
          intrinsics.Ray(static_cast<float>(x), static_cast<float>(y));
      if (Dot(normal, ray) > 0.f) {
        const Vec3f direction = Normalized(ray);
        normal = Normalized(normal +
                            direction * (kGrazing - Dot(normal, direction)));
      }
    }
  }
}

}  // namespace

void FillHoles(ImageView<const Rgb> color,
               const Intrinsics& intrinsics,
               const RefineOptions& options,
               int num_iterations,
               ComposedMap* composed,
               Device& device) {
  if (!HasFilter(options)) {
    return;
  }
  const WeightedMedianOptions filter =
      FilterOptions(options, color.width, color.height);
  const DeviceImage<uint8_t> filled = InterpolateHoles(
      color, intrinsics, num_iterations, filter, &composed->map, device);
  MarkInterpolated(filled.View(), composed, device);
}

void Download(const ComposedMap& composed,
              const DeviceImage<float>& confidence,
              const Intrinsics& intrinsics,
              RefinedMaps* maps) {
  maps->depth = composed.map.depth.ToHost();
  maps->normal = composed.map.normal.ToHost();
  FaceCamera(intrinsics, &maps->normal);
  maps->provenance = composed.provenance.ToHost();
  maps->confidence = confidence.ToHost();
}

void ShowMaps(StageObserver* observer, const RefinedMaps& maps) {
  if (observer == nullptr) {
    return;
  }
  observer->Show(RefineStage::kDepth, maps.depth);
  observer->Show(RefineStage::kNormals, maps.normal);
  observer->Show(RefineStage::kProvenance, maps.provenance);
  observer->Show(RefineStage::kConfidence, maps.confidence);
}

}  // namespace tsar
