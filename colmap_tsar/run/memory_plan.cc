// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/memory_plan.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/scene/model_scene.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/reduce_view.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

constexpr double kBytesPerGigabyte = 1e9;
constexpr double kUsableShare = 0.8;
// Of an uploaded view: gray values and depth.
constexpr int64_t kUploadedBytesPerPixel = 8;

// A table of scores, which is never larger than max_scores.
int64_t ScoresBytes(int64_t num_scores, size_t max_scores) {
  return static_cast<int64_t>(sizeof(float)) *
         std::min(num_scores, static_cast<int64_t>(max_scores));
}

}  // namespace

std::string Gigabytes(int64_t num_bytes) {
  const double gigabytes = static_cast<double>(num_bytes) / kBytesPerGigabyte;
  return Formatted("%.1f GB", std::ceil(10.0 * gigabytes) / 10.0);
}

int NumThatFit(int64_t num_bytes, int64_t bytes_each, int max) {
  return static_cast<int>(std::clamp<int64_t>(
      num_bytes / std::max<int64_t>(bytes_each, 1), 1, std::max(max, 1)));
}

MemoryPlan PlanRefinement(const RefineOptions& options,
                          const WorkspaceOverview& overview) {
  const bool is_joint = NeedsEvidence(options);
  const int64_t pixels = overview.max_num_pixels;
  const int64_t judged = is_joint ? NumJudgedPixels(overview) : pixels;
  const int64_t raster = MaxRasterPixels(judged);
  // Typical: those at the borders of objects are smaller, and those below a
  // quarter of superpixel_size were merged.
  const int64_t superpixels = raster * 3 / 2 / options.superpixel_size + 1;
  const int64_t views = overview.max_num_sources + 1;
  MemoryPlan plan;
  plan.num_sources = overview.max_num_sources;
  plan.device = (1 << 20) + (is_joint ? 45 : 75) * pixels + 60 * raster +
                230 * superpixels + views * kUploadedBytesPerPixel * judged;
  plan.views = kViewBytesPerPixel * std::max(views * judged, pixels);
  plan.main = plan.views + ReadAndWriteBytes(overview);
  if (!is_joint) {
    return plan;
  }
  const int64_t neighbor = 6 * raster + 530 * superpixels;
  const int64_t own = judged + 10 * raster + 800 * superpixels;
  const int64_t labeling = 30 * raster + 3600 * superpixels +
                           views * (13 * raster + 512 * superpixels);
  plan.label_view = 2 * own + (views + 1) * neighbor + labeling;
  const int64_t make_evidence = 45 * raster + 2000 * superpixels +
                                ScoresBytes(superpixels * (superpixels + 60),
                                            DiscoverPlanesOptions().max_scores);
  plan.main += std::max(make_evidence, plan.label_view);
  const auto block = static_cast<int64_t>(ModelSceneOptions().max_block_views);
  plan.model_block =
      block * (neighbor + superpixels * (2200 + 160 * block)) +
      ScoresBytes(block * superpixels * block * 100, kMaxBlockScores);
  return plan;
}

int64_t ReadAndWriteBytes(const WorkspaceOverview& overview) {
  // The photo and the mask as decoded and as scaled, a depth prior as decoded,
  // and the refined maps with an encoded one.
  return (overview.has_priors ? 24 : 8) * overview.max_num_image_pixels +
         34 * overview.max_num_pixels;
}

int64_t NumJudgedPixels(const WorkspaceOverview& overview) {
  return std::min(overview.max_num_pixels,
                  int64_t{kMaxJudgingSide} * kMaxJudgingSide);
}

size_t NumEvidenceViews(const WorkspaceOverview& overview, int num_images) {
  return static_cast<size_t>(num_images + 1) *
         static_cast<size_t>(overview.max_num_sources + 1);
}

int64_t MainMemoryBudget(double cache_size, int64_t machine_bytes) {
  return static_cast<int64_t>(
      std::min(cache_size * kBytesPerGigabyte,
               kUsableShare * static_cast<double>(machine_bytes)));
}

ImagesAtWork FitIntoMainMemory(const MemoryPlan& plan,
                               const ImagesAtWork& wanted,
                               bool on_cpu,
                               double cache_size,
                               int64_t machine_bytes) {
  const int64_t budget = MainMemoryBudget(cache_size, machine_bytes);
  const int64_t computing = on_cpu ? plan.device - plan.copies : 0;
  const int64_t needed = plan.main + computing;
  const std::string what_needs = "an image of this workspace with its " +
                                 std::to_string(plan.num_sources) +
                                 " source images needs " + Gigabytes(needed) +
                                 " of main memory at a time";
  if (needed > machine_bytes) {
    throw Error(ErrorCode::kOutOfMemory,
                what_needs + ", and this machine gives " +
                    Gigabytes(machine_bytes) + "; " + plan.advice);
  }
  if (needed > budget) {
    Warn(what_needs + ", more than the " + Gigabytes(budget) +
         " that the run may take (" + OptionName("cache_size") +
         ", and four fifths of the machine's memory); the run takes that "
         "much. If it is not there, " +
         plan.advice);
  }
  ImagesAtWork fit = wanted;
  if (on_cpu) {
    fit.num_workers = NumThatFit(budget, needed, wanted.num_workers);
  }
  const int64_t left =
      std::max<int64_t>(budget - fit.num_workers * computing, 0);
  fit.num_threads = NumThatFit(left, plan.main, wanted.num_threads);
  fit.view_bytes =
      std::max<int64_t>(left - fit.num_threads * (plan.main - plan.views), 0);
  return fit;
}

}  // namespace tsar
