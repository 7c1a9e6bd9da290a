// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/fill_holes.h"

#include "colmap_tsar/superpixels/correlation.h"

namespace tsar {

void FillHoles(ImageView<const Rgb> color,
               const Intrinsics& intrinsics,
               const RefineOptions& options,
               ComposedMap* composed,
               Device& device) {
  if (!options.refine || !options.weighted_median) {
    return;
  }
  WeightedMedianOptions filter;
  filter.radius =
      ScaledRadius(2.f * options.window_radius, color.width, color.height);
  filter.spatial_sigma = static_cast<float>(options.spatial_sigma);
  filter.color_sigma = static_cast<float>(options.color_sigma);
  filter.min_support = 1.f / 3.f;
  const DeviceImage<uint8_t> filled = InterpolateHoles(color,
                                                       intrinsics,
                                                       options.num_iterations,
                                                       filter,
                                                       &composed->map,
                                                       device);
  MarkInterpolated(filled.View(), composed, device);
}

RefinedMaps Download(const ComposedMap& composed,
                     const DeviceImage<float>& confidence) {
  RefinedMaps maps;
  maps.depth = composed.map.depth.ToHost();
  maps.normal = composed.map.normal.ToHost();
  maps.provenance = composed.provenance.ToHost();
  maps.confidence = confidence.ToHost();
  return maps;
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
