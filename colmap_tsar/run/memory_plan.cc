// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/memory_plan.h"

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/compose/stage_memory.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/io/masks_and_labels.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/scene/model_scene.h"
#include "colmap_tsar/view/reduce_view.h"
#include "colmap_tsar/view/refined_maps.h"
#include "colmap_tsar/view/view_data.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

// Confidence in 8 bits, and an encoded image in a growing buffer.
constexpr int64_t kEncodingBytesPerPixel = 3;
// The number of sources of an image that it does not share with another image
// at work.
constexpr int kViewsPerWorker = 1;

size_t NumEvidenceViews(int num_sources, size_t num_images) {
  return (num_images + 1) * static_cast<size_t>(num_sources + 1);
}

int LongestSide(const WorkspaceOverview& overview) {
  // Of all maps with these pixels, a square one has the shortest sides.
  const auto min_side = static_cast<int>(
      std::ceil(std::sqrt(static_cast<double>(overview.max_num_pixels))));
  return std::max(overview.max_side, min_side);
}

// The size of the maps of one row of squares (see ReduceView).
int64_t RowsOfSquaresBytes(const WorkspaceOverview& overview) {
  const int side = LongestSide(overview);
  return ViewDataBytes(int64_t{side} * ReductionFactor(side, side),
                       overview.has_costs);
}

// The number of pixels of the largest map at the size at which it is judged.
int64_t NumJudgedPixels(const WorkspaceOverview& overview) {
  return HasReducedViews(overview)
             ? std::min(overview.max_num_pixels,
                        int64_t{kMaxJudgingSide} * kMaxJudgingSide)
             : overview.max_num_pixels;
}

// The size of the part of a label image that is kept.
int64_t SegmentsBytes(const WorkspaceOverview& overview) {
  return BytesOf<uint16_t>(
      std::min(overview.max_num_label_pixels,
               int64_t{kMaxLabelImageSide} * kMaxLabelImageSide));
}

}  // namespace

MemoryPlan PlanRefinement(const RefineOptions& options,
                          const WorkspaceOverview& overview) {
  const int64_t num_pixels = overview.max_num_pixels;
  const int num_sources = overview.max_num_sources;
  MemoryPlan plan;
  plan.num_sources = num_sources;
  plan.uploaded_view = UploadedViewBytes(num_pixels);
  plan.view = ViewBytes(overview);
  plan.load = LoadBytes(overview);
  plan.result =
      RefinedMapsBytes(num_pixels) +
      std::max(kEncodingBytesPerPixel * num_pixels, ReadMaskBytes(overview));
  const int64_t segments_work =
      overview.max_num_label_pixels > 0 ? SegmentsWorkingBytes(num_pixels) : 0;
  if (!NeedsEvidence(options)) {
    plan.work = RefineImageWorkingBytes(options, num_pixels) + segments_work;
    return plan;
  }
  const int64_t num_judged_pixels = NumJudgedPixels(overview);
  plan.uploaded_view = UploadedViewBytes(num_judged_pixels);
  plan.label_work = LabelViewWorkingBytes(options, num_pixels, num_sources + 1);
  plan.work = std::max(
      {MeasureImageWorkingBytes(options, num_judged_pixels) + segments_work,
       plan.label_work,
       ComposeImageWorkingBytes(options, num_pixels, num_judged_pixels)});
  plan.result =
      std::max(plan.result, MeasuredImageBytes(options, num_judged_pixels));
  plan.make_evidence = MakeEvidenceMainBytes(options, num_pixels);
  plan.own_evidence = ViewEvidenceBytes(options, num_judged_pixels);
  plan.neighbor_evidence = NeighborEvidenceBytes(options, num_pixels);
  const int num_block_views =
      static_cast<int>(ModelSceneOptions().max_block_views);
  plan.model_block = num_block_views * plan.neighbor_evidence +
                     ModelBlockMainBytes(options, num_pixels, num_block_views);
  // A second copy of the view's own evidence, without the part beyond creases.
  const int64_t bounded_evidence =
      options.bounding_creases ? plan.own_evidence : 0;
  plan.label_view = EvidenceBytes(plan, 1) + bounded_evidence +
                    LabelViewMainBytes(options, num_pixels, num_sources + 1);
  if (HasReducedViews(overview)) {
    plan.whole_view = plan.view;
    plan.view = ReducedViewBytes(overview);
    // Rows of both types of maps, or the full view until it has been reduced.
    plan.load += 2 * RowsOfSquaresBytes(overview);
  }
  return plan;
}

int64_t ViewBytes(const WorkspaceOverview& overview) {
  return ViewDataBytes(overview.max_num_pixels, overview.has_costs) +
         overview.prior_memory.prior + SegmentsBytes(overview);
}

int64_t LoadBytes(const WorkspaceOverview& overview) {
  // The photo as decoded and as scaled; maps are read in small pieces. The mask
  // has been read before, and only its pixels of the map are left. The depth
  // prior and the label image are read after the photo.
  return std::max({BytesOf<Rgb>(overview.max_num_image_pixels) +
                       BytesOf<Rgb>(overview.max_num_pixels),
                   overview.prior_memory.to_read,
                   BytesOf<uint16_t>(overview.max_num_label_pixels)}) +
         (overview.has_masks ? BytesOf<uint8_t>(overview.max_num_pixels) : 0);
}

int64_t ReadMaskBytes(const WorkspaceOverview& overview) {
  // The mask as OpenCV decodes it, at full size, and scaled.
  return overview.has_masks
             ? BytesOf<uint8_t>(2 * overview.max_num_image_pixels +
                                overview.max_num_pixels)
             : 0;
}

bool HasReducedViews(const WorkspaceOverview& overview) {
  return LongestSide(overview) > kMaxJudgingSide;
}

int64_t ReducedViewBytes(const WorkspaceOverview& overview) {
  return ViewDataBytes(NumJudgedPixels(overview), overview.has_costs) +
         overview.prior_memory.prior + SegmentsBytes(overview);
}

int64_t BytesForViews(const MemoryPlan& plan) {
  return std::max((plan.num_sources + 1) * plan.view, plan.whole_view);
}

int64_t SharedViewBytes(const MemoryPlan& plan, int num_workers) {
  return plan.uploaded_view *
         (plan.num_sources + num_workers * kViewsPerWorker);
}

MemoryPlan ForLabelsAlone(MemoryPlan plan) {
  plan.work = plan.label_work;
  plan.uploaded_view = 0;
  return plan;
}

int64_t DeviceBytes(const MemoryPlan& plan, int num_workers) {
  const int64_t in_use = num_workers * plan.num_sources * plan.uploaded_view;
  return num_workers * plan.work +
         std::max(in_use, SharedViewBytes(plan, num_workers));
}

size_t NumEvidenceViews(const WorkspaceOverview& overview, size_t num_images) {
  return NumEvidenceViews(overview.max_num_sources, num_images);
}

int64_t EvidenceBytes(const MemoryPlan& plan, size_t num_images) {
  const auto num_views =
      static_cast<int64_t>(NumEvidenceViews(plan.num_sources, num_images));
  return num_views * plan.neighbor_evidence +
         static_cast<int64_t>(num_images) * plan.own_evidence;
}

}  // namespace tsar
