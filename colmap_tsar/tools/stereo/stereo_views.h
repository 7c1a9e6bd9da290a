// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/compose/depth_interval.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/plane_maps.h"
#include "colmap_tsar/matching/views.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <vector>

namespace tsar {

// An image and its sources in a device's memory, at the size of their views
// (level 0) and at levels of half the previous size each.
class StereoViews {
 public:
  // Holds a reference to the device.
  StereoViews(const ViewData& reference,
              const std::vector<const ViewData*>& sources,
              int num_levels,
              Device& device);

  // The reference without depth and normal.
  ReferenceView Reference(int level) const;
  // The sources, with depth at level 0 if the views have it.
  Buffer<SourceView> Sources(int level) const;

 private:
  struct Source {
    Camera camera;
    std::vector<DeviceImage<GrayPair>> grays;  // By level, as below.
    DeviceImage<float> depth;
  };

  Device& device_;
  Camera camera_;
  std::vector<DeviceImage<float>> grays_;
  std::vector<Source> sources_;
};

PatchMatchOptions SearchOptions(const StereoOptions& options,
                                const DepthInterval& range);

// The uses of random numbers in an image, each with numbers of its own.
inline constexpr int kFirstPlanes = 0;
inline constexpr int kLevels = 1;              // Plus the level.
inline constexpr int kGeometricPasses = 1000;  // Plus the pass.

// The key of the random numbers of one use. image_stream: the image's key.
uint32_t StreamOf(uint32_t image_stream, int use);

// Runs PatchMatch from the depth and normal of `view`, those of the previous
// pass. inputs: those with this view as reference.
DepthNormalImages UpdateMaps(const ViewData& view,
                             const PatchMatchInputs& inputs,
                             const PatchMatchOptions& search,
                             Device& device);

// The options of the filter for an image with num_sources sources.
HypothesisFilterOptions FilterOptions(const StereoOptions& options,
                                      int num_sources);

// Filters the depths of the reference and, with smooth_normals, its normals.
void FilterMaps(const PatchMatchInputs& inputs,
                const HypothesisFilterOptions& filter,
                bool smooth_normals,
                Device& device,
                DepthNormalImages* maps);

}  // namespace tsar
