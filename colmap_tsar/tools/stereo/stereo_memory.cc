// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_memory.h"

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/tools/stereo/fill_under_prior.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/view/device_views.h"

#include <algorithm>

namespace tsar {
namespace {

// Main memory for the alignment of a depth prior, for each pixel of the raster:
// its images, and lists of samples and of what is predicted of them.
constexpr int64_t kAlignBytesPerPixel = 100;

// Bytes of the device's memory, including the sources, linear in the pixels.
// The factors were measured (tests/tools/stereo/stereo_memory_test.cc).
int64_t MatchingBytes(const StereoOptions& options,
                      int64_t num_pixels,
                      int num_sources) {
  const auto linear = [&](int64_t fixed, int64_t per_source) {
    constexpr int64_t kFixed = 16384;
    // Many sources take additional memory for view selection.
    const int64_t num_more = std::max(0, num_sources - 16);
    return kFixed + num_pixels * (fixed + per_source * num_sources + num_more);
  };
  return FillsUnderPrior(options)   ? linear(74, 8)
         : options.geom_consistency ? linear(57, 8)
                                    : linear(50, 5);
}

}  // namespace

MemoryPlan PlanStereo(const StereoOptions& options,
                      const WorkspaceOverview& overview) {
  const int64_t num_pixels = overview.max_num_pixels;
  MemoryPlan plan;
  plan.num_sources = overview.max_num_sources;
  // Each image uploads its sources again, so that they count as work.
  plan.work = MatchingBytes(options, num_pixels, plan.num_sources) +
              (overview.has_masks ? BytesOf<uint8_t>(num_pixels) : 0);
  plan.view = ViewBytes(overview);
  // Costs are copied from and to one array for their file; before that, prior
  // planes exist besides the maps, or depth and normal besides those they are
  // merged with.
  const int64_t costs = 2 * BytesOf<float>(num_pixels);
  plan.load = std::max(LoadBytes(overview), costs);
  const int64_t aligning =
      overview.prior_memory.prior > 0
          ? kAlignBytesPerPixel * MaxRasterPixels(num_pixels)
          : 0;
  const int64_t filling =
      BytesOf<Plane>(num_pixels) + BytesOf<float>(num_pixels) + aligning;
  plan.result =
      StereoMapsBytes(num_pixels) +
      std::max(FillsUnderPrior(options) ? std::max(costs, filling) : costs,
               ReadMaskBytes(overview));
  return plan;
}

}  // namespace tsar
