// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/memory_plan.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/scene_planes/discover_planes.h"

#include <algorithm>
#include <cstdio>

namespace tsar {
namespace {

// Colour 3, depth 4, normal 12.
constexpr int64_t kBytesPerViewPixel = 19;
constexpr int64_t kBytesPerCostsPixel = 8;
// The hypotheses of the other type: depth 4, normal 12.
constexpr int64_t kBytesPerOtherPixel = 16;
constexpr int64_t kBytesPerColorPixel = 3;
// Depth 4, normal 12, confidence 4, provenance 1; the rest is for encoding.
constexpr int64_t kBytesPerResultPixel = 24;
// Gray 4, depth 4.
constexpr int64_t kBytesPerSourcePixel = 8;
// The reference with all intermediate maps, of which the stages hold at most 51
// at a time, and what they hold for each pixel of the reduced raster; a test
// compares.
constexpr int64_t kBytesPerReferencePixel = 52;
constexpr int64_t kBytesPerRasterPixel = 60;
constexpr int64_t kMaxRasterPixels = int64_t{777} * 777;
// A view's evidence as its neighbours need it: labels 2, depth 4, and per
// superpixel of 400 pixels 32 observations of 16.
constexpr int64_t kEvidenceBytesPerRasterPixel = 8;
// What was measured in an image, on the reduced raster: labels 4, samples 12,
// planes of regions 16, texture 4, contrast 4, planes of superpixels.
constexpr int64_t kBytesPerMeasuredPixel = 41;
// And what is there while it becomes evidence: observations 16, three lists of
// pixels 12, residuals 4, the evidence itself.
constexpr int64_t kBytesPerGatheredPixel = 42;
// Where planes are looked for. Views keep some 40 candidates each, and more
// where they have many regions. A superpixel has four blocks of observations of
// 192 bytes, twice while they are copied to the device, and scores on 40
// planes, as many fits of these, and some joint ones.
constexpr int64_t kPixelsPerSuperpixel = 400;
constexpr int64_t kCandidatesPerView = 100;
constexpr int64_t kBytesPerScoredSuperpixel = 2500;
// Of an image that is worked on beside another, few sources are not the
// other's.
constexpr int kViewsPerWorker = 1;
// Beside the maps: tables of superpixels and regions, which do not grow with
// the map, and the kernels that the driver loads when they are first used.
constexpr int64_t kFixedBytes = int64_t{64} << 20;

int64_t NumRasterPixels(const WorkspaceOverview& overview) {
  return std::min(overview.max_num_pixels, kMaxRasterPixels);
}

std::string Gigabytes(int64_t num_bytes) {
  char text[64];
  std::snprintf(
      text, sizeof(text), "%.1f GB", static_cast<double>(num_bytes) / 1e9);
  return text;
}

}  // namespace

int64_t ViewBytes(const WorkspaceOverview& overview) {
  return overview.max_num_pixels *
         (kBytesPerViewPixel + (overview.has_costs ? kBytesPerCostsPixel : 0));
}

int64_t LoadBytes(const WorkspaceOverview& overview) {
  const int64_t for_maps =
      overview.max_num_pixels *
      ((overview.has_other_type ? kBytesPerOtherPixel : 0) +
       (overview.has_costs ? kBytesPerCostsPixel : 0));
  // As it was decoded, and as it was scaled.
  const int64_t for_color =
      kBytesPerColorPixel *
      (overview.max_num_image_pixels + overview.max_num_pixels);
  return std::max(for_maps, for_color);
}

int64_t ResultBytes(const WorkspaceOverview& overview) {
  return std::max(overview.max_num_pixels * kBytesPerResultPixel,
                  overview.max_num_pixels +
                      NumRasterPixels(overview) * kBytesPerMeasuredPixel);
}

int64_t SourceBytes(const WorkspaceOverview& overview) {
  return overview.max_num_pixels * kBytesPerSourcePixel *
         overview.max_num_sources;
}

int64_t SharedViewBytes(const WorkspaceOverview& overview, int num_workers) {
  return SourceBytes(overview) + num_workers * kViewsPerWorker *
                                     kBytesPerSourcePixel *
                                     overview.max_num_pixels;
}

int64_t WorkBytes(const WorkspaceOverview& overview) {
  return overview.max_num_pixels * kBytesPerReferencePixel +
         NumRasterPixels(overview) * kBytesPerRasterPixel +
         SourceBytes(overview);
}

size_t NumEvidenceViews(const WorkspaceOverview& overview, size_t num_images) {
  return (num_images + 1) * static_cast<size_t>(overview.max_num_sources + 1);
}

int64_t EvidenceBytes(const WorkspaceOverview& overview, size_t num_images) {
  return static_cast<int64_t>(NumEvidenceViews(overview, num_images)) *
         NumRasterPixels(overview) * kEvidenceBytesPerRasterPixel;
}

int64_t DiscoveryBytes(const WorkspaceOverview& overview) {
  const int64_t num_views = overview.max_num_sources + 1;
  const int64_t num_superpixels =
      num_views * (NumRasterPixels(overview) / kPixelsPerSuperpixel + 1);
  const int64_t num_scores =
      std::min(static_cast<int64_t>(DiscoverPlanesOptions().max_scores),
               num_superpixels * num_views * kCandidatesPerView);
  return num_scores * static_cast<int64_t>(sizeof(float)) +
         num_superpixels * kBytesPerScoredSuperpixel +
         NumRasterPixels(overview) * kBytesPerGatheredPixel;
}

int NumGpuWorkers(const WorkspaceOverview& overview,
                  int64_t free_bytes,
                  const std::string& gpu) {
  const int64_t needed = WorkBytes(overview) + kFixedBytes;
  if (needed > free_bytes) {
    throw Error(
        ErrorCode::kDevice,
        gpu + ": an image of this workspace needs " + Gigabytes(needed) +
            " of GPU memory and " + Gigabytes(free_bytes) +
            " are free; close other programs that use the GPU, choose another "
            "one with " +
            OptionName("gpu_index") +
            ", run patch_match_stereo with a "
            "smaller --PatchMatchStereo.max_image_size, or pass " +
            OptionName("device") + " cpu");
  }
  return static_cast<int>(
      std::min<int64_t>(kMaxGpuWorkers, free_bytes / needed));
}

}  // namespace tsar
