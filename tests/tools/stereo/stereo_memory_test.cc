// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_image.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/run/counting_device.h"
#include "tests/support/synthetic_views.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

struct Matched {
  int64_t photometric = 0;  // Bytes at a time.
  int64_t geometric = 0;
};

Matched Match(const SyntheticViews& drawn,
              size_t num_sources,
              const StereoOptions& options) {
  const DepthInterval range{2.0, 10.0};
  // The first pass has no maps to read.
  std::vector<ViewData> photos = drawn.views;
  std::vector<const ViewData*> sources;
  std::vector<const ViewData*> photo_sources;
  for (size_t i = 0; i < num_sources; ++i) {
    const size_t view = 1 + i % (photos.size() - 1);
    photos[view].depth = {};
    sources.push_back(&drawn.views[view]);
    photo_sources.push_back(&photos[view]);
  }
  photos[0].depth = {};
  Matched matched;
  CountingDevice first("", SIZE_MAX, 2);
  MatchImage(
      photos[0], UploadViews(photo_sources, first), range, 1, options, first);
  matched.photometric = static_cast<int64_t>(first.PeakMemory());
  CountingDevice second("", SIZE_MAX, 2);
  MatchImageGeometrically(drawn.views[0],
                          UploadViews(sources, second),
                          range,
                          1,
                          options.num_geometric_passes - 1,
                          /*keeps_holes=*/false,
                          options,
                          second);
  matched.geometric = static_cast<int64_t>(second.PeakMemory());
  return matched;
}

StereoOptions FastOptions(int num_levels) {
  StereoOptions options;
  options.num_iterations = 1;
  options.window_radius = 2;
  options.num_levels = num_levels;
  return options;
}

TEST(StereoMemory, IsWhatMatchingTakes) {
  for (const auto& [width, height] : {std::pair{64, 48}, {161, 41}}) {
    SCOPED_TRACE(width);
    SyntheticViewsOptions size;
    size.width = width;
    size.height = height;
    const SyntheticViews drawn = MakeSyntheticViews(size);
    const int64_t num_pixels = int64_t{width} * height;
    for (const int num_levels : {1, 3}) {
      SCOPED_TRACE(num_levels);
      const StereoOptions options = FastOptions(num_levels);
      for (const size_t num_sources : {size_t{1}, size_t{4}, size_t{40}}) {
        SCOPED_TRACE(num_sources);
        const Matched matched = Match(drawn, num_sources, options);
        WorkspaceOverview overview;
        overview.max_num_pixels = num_pixels;
        overview.max_num_image_pixels = num_pixels;
        overview.max_num_sources = static_cast<int>(num_sources);
        const int64_t planned = PlanStereo(overview).device;
        EXPECT_GE(planned, std::max(matched.photometric, matched.geometric));
        EXPECT_LE(planned, 2 * matched.geometric);
      }
    }
  }
}

}  // namespace
}  // namespace tsar
