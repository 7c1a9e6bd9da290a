// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/stage_memory.h"

#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/scene/labeling/label_inputs.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"
#include "colmap_tsar/view/device_views.h"

#include <algorithm>

namespace tsar {
namespace {

// The number of candidate planes of a view's regions, which is seldom larger. A
// view also has its own planes, at most DiscoverPlanesOptions::max_planes.
constexpr int kCandidatesOfRegions = 60;

// The typical number of superpixels of a raster: those below a quarter of
// superpixel_size were merged, and those at the borders of objects are smaller
// than superpixel_size. For sums over many views, the maximum of each would be
// far too large.
int64_t NumSuperpixels(const RefineOptions& options, int64_t num_pixels) {
  return MaxRasterPixels(num_pixels) * 3 / 2 / options.superpixel_size + 1;
}

// The tables of scores of all planes for all superpixels.
int64_t ScoresBytes(int64_t num_superpixels,
                    int64_t num_candidates,
                    size_t max_scores) {
  return static_cast<int64_t>(sizeof(float)) *
         std::min(num_superpixels * num_candidates,
                  static_cast<int64_t>(max_scores));
}

// The memory of the stages up to the surfaces of one view.
int64_t SingleViewBytes(const RefineOptions& options,
                        int64_t bytes_per_pixel,
                        int64_t num_pixels) {
  // The accumulator of the line detector has the same size for small maps.
  constexpr int64_t kFixed = 720000;
  return kFixed + bytes_per_pixel * num_pixels +
         57 * MaxRasterPixels(num_pixels) +
         230 * NumSuperpixels(options, num_pixels);
}

}  // namespace

int64_t RefineImageWorkingBytes(const RefineOptions& options,
                                int64_t num_pixels) {
  return SingleViewBytes(options, 44, num_pixels);
}

int64_t MeasureImageWorkingBytes(const RefineOptions& options,
                                 int64_t num_pixels) {
  return SingleViewBytes(options, 44, num_pixels);
}

int64_t ComposeImageWorkingBytes(const RefineOptions& options,
                                 int64_t num_pixels,
                                 int64_t num_judged_pixels) {
  constexpr int64_t kFixed = 90000;
  return kFixed + 43 * num_pixels + 52 * MaxRasterPixels(num_judged_pixels) +
         120 * NumSuperpixels(options, num_judged_pixels);
}

int64_t MakeEvidenceMainBytes(const RefineOptions& options,
                              int64_t num_pixels) {
  const int64_t num_raster_pixels = MaxRasterPixels(num_pixels);
  const int64_t num_superpixels = NumSuperpixels(options, num_pixels);
  // Each superpixel that has a plane is a candidate.
  return std::max(45 * num_raster_pixels,
                  30 * num_raster_pixels + 2000 * num_superpixels +
                      ScoresBytes(num_superpixels,
                                  num_superpixels + kCandidatesOfRegions,
                                  DiscoverPlanesOptions().max_scores));
}

int64_t ModelBlockMainBytes(const RefineOptions& options,
                            int64_t num_pixels,
                            int num_views) {
  const int64_t num_superpixels =
      num_views * NumSuperpixels(options, num_pixels);
  const int64_t num_candidates =
      int64_t{num_views} *
      (kCandidatesOfRegions + DiscoverPlanesOptions().max_planes);
  // The observations, and the scores of the selected planes.
  return num_superpixels * (2200 + 160 * num_views) +
         ScoresBytes(num_superpixels, num_candidates, kMaxBlockScores);
}

int64_t LabelViewWorkingBytes(const RefineOptions& options,
                              int64_t num_pixels,
                              int num_views) {
  LabelingSize size;
  size.num_views = num_views;
  size.num_pixels = MaxRasterPixels(num_pixels);
  size.num_superpixels = NumSuperpixels(options, num_pixels);
  size.num_observations = std::min(
      size.num_pixels, size.num_superpixels * kMaxObservationsPerSuperpixel);
  // The maximum of one view, and as many more from its sources.
  size.num_planes = 2 * DiscoverPlanesOptions().max_planes;
  return LabelInModelWorkingBytes(
      size, {/*confident_depth=*/true, /*superpixels=*/true});
}

int64_t LabelViewMainBytes(const RefineOptions& options,
                           int64_t num_pixels,
                           int num_views) {
  const int64_t num_costs = NumSuperpixels(options, num_pixels) * 2 *
                            DiscoverPlanesOptions().max_planes;
  return num_costs * static_cast<int64_t>(sizeof(PlaneCost) + sizeof(float)) +
         LabelViewWorkingBytes(options, num_pixels, num_views);
}

int64_t MeasuredImageBytes(const RefineOptions& options, int64_t num_pixels) {
  return num_pixels + 59 * MaxRasterPixels(num_pixels) +
         16 * NumSuperpixels(options, num_pixels);
}

int64_t ViewEvidenceBytes(const RefineOptions& options, int64_t num_pixels) {
  return num_pixels + 9 * MaxRasterPixels(num_pixels) +
         800 * NumSuperpixels(options, num_pixels);
}

int64_t NeighborEvidenceBytes(const RefineOptions& options,
                              int64_t num_pixels) {
  return 6 * MaxRasterPixels(num_pixels) +
         530 * NumSuperpixels(options, num_pixels);
}

}  // namespace tsar
