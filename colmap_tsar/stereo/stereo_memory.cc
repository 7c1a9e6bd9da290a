// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/stereo/stereo_memory.h"

#include "colmap_tsar/device/working_bytes.h"
#include "colmap_tsar/stereo/fill_under_prior.h"
#include "colmap_tsar/stereo/stereo_image.h"

#include <algorithm>

namespace tsar {

MemoryPlan PlanStereo(const StereoOptions& options,
                      const WorkspaceOverview& overview) {
  const int64_t num_pixels = overview.max_num_pixels;
  MemoryPlan plan;
  plan.num_sources = overview.max_num_sources;
  // Each image uploads its sources anew: they count as work.
  plan.work = MatchImageWorkingBytes(options, num_pixels, plan.num_sources);
  if (options.geom_consistency) {
    plan.work = std::max(
        plan.work,
        MatchImageGeometricallyWorkingBytes(num_pixels, plan.num_sources) +
            (overview.has_masks ? BytesOf<uint8_t>(num_pixels) : 0));
  }
  if (FillsUnderPrior(options)) {
    plan.work = std::max(
        plan.work, MatchUnderPriorWorkingBytes(num_pixels, plan.num_sources));
  }
  plan.view = ViewBytes(overview);
  // Costs are copied from and into one array for their file; before they are
  // written, prior planes lie beside the maps, or depth and normal beside those
  // they are merged with.
  const int64_t costs = 2 * BytesOf<float>(num_pixels);
  plan.load = std::max(LoadBytes(overview), costs);
  const int64_t filling =
      BytesOf<Plane>(num_pixels) + BytesOf<float>(num_pixels);
  plan.result =
      StereoMapsBytes(num_pixels) +
      std::max(FillsUnderPrior(options) ? std::max(costs, filling) : costs,
               ReadMaskBytes(overview));
  return plan;
}

}  // namespace tsar
