// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/memory_plan.h"

#include "colmap_tsar/base/error.h"

#include <algorithm>
#include <cstdio>

namespace tsar {
namespace {

// Colour 3, depth 4, normal 12, two costs 8.
constexpr int64_t kBytesPerViewPixel = 27;
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
// Of an image that is worked on beside another, few sources are not the
// other's.
constexpr int kViewsPerWorker = 1;
// Beside the maps: tables of superpixels and regions, which do not grow with
// the map, and the kernels that the driver loads when they are first used.
constexpr int64_t kFixedBytes = int64_t{64} << 20;

std::string Gigabytes(int64_t num_bytes) {
  char text[64];
  std::snprintf(
      text, sizeof(text), "%.1f GB", static_cast<double>(num_bytes) / 1e9);
  return text;
}

}  // namespace

int64_t ViewBytes(const WorkspaceOverview& overview) {
  return overview.max_num_pixels * kBytesPerViewPixel;
}

int64_t ResultBytes(const WorkspaceOverview& overview) {
  return overview.max_num_pixels * kBytesPerResultPixel;
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
         std::min(overview.max_num_pixels, kMaxRasterPixels) *
             kBytesPerRasterPixel +
         SourceBytes(overview);
}

size_t NumEvidenceViews(const WorkspaceOverview& overview, size_t num_workers) {
  return (num_workers + 1) * static_cast<size_t>(overview.max_num_sources + 1);
}

int64_t EvidenceBytes(const WorkspaceOverview& overview, size_t num_workers) {
  return static_cast<int64_t>(NumEvidenceViews(overview, num_workers)) *
         std::min(overview.max_num_pixels, kMaxRasterPixels) *
         kEvidenceBytesPerRasterPixel;
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
            "one with --TsarRefine.gpu_index, run patch_match_stereo with a "
            "smaller --PatchMatchStereo.max_image_size, or pass "
            "--TsarRefine.device cpu");
  }
  return static_cast<int>(
      std::min<int64_t>(kMaxGpuWorkers, free_bytes / needed));
}

}  // namespace tsar
