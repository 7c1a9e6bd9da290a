// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/matching/views.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/refined_maps.h"
#include "colmap_tsar/view/superpixels/samples.h"

#include <cstdint>

namespace tsar {

struct ComposeInputs {
  ImageView<const uint8_t> trusted;  // Nonzero where the hypothesis is kept.
  PlaneRaster superpixel_planes;     // May be empty.
  PlaneRaster region_planes;         // May be empty.
  // The Confirmation of each hypothesis: confirmed ones are kept as well. May
  // be empty.
  ImageView<const uint8_t> confirmations{};
};

// A composed map in a kernel.
struct ComposedViews {
  ImageView<float> depth;
  ImageView<Vec3f> normal;
  ImageView<uint8_t> provenance;

  TSAR_HD Provenance Source(int x, int y) const {
    return static_cast<Provenance>(provenance(x, y));
  }
  TSAR_HD void Set(
      int x, int y, float z, const Vec3f& direction, Provenance source) const {
    depth(x, y) = z;
    normal(x, y) = direction;
    provenance(x, y) = static_cast<uint8_t>(source);
  }
};

struct ComposedMap {
  DepthNormalImages map;
  DeviceImage<uint8_t> provenance;

  ComposedViews Views() {
    return {map.depth.View(), map.normal.View(), provenance.View()};
  }
};

// Composes one map from the results of the stages. A trusted measurement close
// to a plane moves onto it, which removes its noise; any other one keeps its
// depth. Where nothing is trusted, the plane with the more local support is
// used: the superpixel's, unless the region's agrees with it. own: the measured
// hypotheses, whose memory is moved to the result.
ComposedMap ComposeMap(DepthNormalImages own,
                       const ComposeInputs& inputs,
                       const DisparityScale& scale,
                       Device& device);

// The confidence of each depth, in [0, 1]: the score where it was measured, and
// for filled pixels a fixed value by provenance, at most 0.5; 0 where there is
// no depth.
DeviceImage<float> ComputeComposedConfidence(const ComposedMap& composed,
                                             ImageView<const float> score,
                                             Device& device);

// Clears depth, normal and provenance where the confidence is less than
// min_confidence, which is in [0, 1], or 0. Other normals that face away from
// the camera, a few of those that were measured at grazing angles, are tilted
// as little as is needed; all others keep their bytes. Returns the confidences
// by ToConfidenceLevel(), 0 where cleared. intrinsics: of the map.
DeviceImage<uint8_t> FinishMap(float min_confidence,
                               const Intrinsics& intrinsics,
                               ImageView<const float> confidence,
                               ComposedMap* composed,
                               Device& device);

// R2: fills small holes by the filter F_B, and marks them as interpolated.
// color, intrinsics: those of the map. num_iterations: the window doubles from
// round to round, each reading the result of the previous one. Does nothing if
// the options disable it.
void FillHoles(ImageView<const Rgb> color,
               const Intrinsics& intrinsics,
               const RefineOptions& options,
               int num_iterations,
               ComposedMap* composed,
               Device& device);

// Downloads the maps that are always made.
void Download(const ComposedMap& composed,
              const DeviceImage<uint8_t>& levels,
              RefinedMaps* maps);

}  // namespace tsar
