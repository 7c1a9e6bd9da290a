// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/depth_interval.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tsar {

// The maps of one image. Costs are 1 - NCC, in [0, 2], as COLMAP's patch writes
// them; kCostWithoutEvidence without evidence. Geometric passes except the last
// leave them empty.
struct StereoMaps {
  Image<float> depth;
  Image<Vec3f> normal;
  Image<float> min_cost;
  Image<float> second_cost;
};

// The sources of an image in the memory of the device that matches it.
using UploadedSources = std::vector<std::shared_ptr<const UploadedView>>;

// Matches an image with its sources, coarse to fine. Of the views, it uses
// color and camera; the sources must have no depth. Every pixel gets a depth.
// stream: key of random numbers.
StereoMaps MatchImage(const ViewData& reference,
                      const UploadedSources& sources,
                      const DepthInterval& range,
                      uint32_t stream,
                      const StereoOptions& options,
                      Device& device);

// Updates the depth and normal of the reference with geometric consistency to
// the depth of the sources, some of which may have none. keeps_holes: whether
// pixels of the reference without a depth, which are masked, get none. pass
// counts from 0. The last pass filters: depths that too few sources confirm
// become 0, with their normals.
StereoMaps MatchImageGeometrically(const ViewData& reference,
                                   const UploadedSources& sources,
                                   const DepthInterval& range,
                                   uint32_t stream,
                                   int pass,
                                   bool keeps_holes,
                                   const StereoOptions& options,
                                   Device& device);

// The filter of the last pass on maps of another program, which the reference
// has as its depth and normal. Returns depths and normals without costs.
StereoMaps FilterImage(const ViewData& reference,
                       const UploadedSources& sources,
                       const StereoOptions& options,
                       Device& device);

// The memory plan of tsar_stereo. overview: that of the maps to make.
MemoryPlan PlanStereo(const WorkspaceOverview& overview);

}  // namespace tsar
