// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/unmatched_depths.h"

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/gray_pair.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/view_data.h"

#include <algorithm>

namespace tsar {
namespace {

void DropDepth(int x, int y, ViewData* view) {
  view->depth(x, y) = 0.f;
  view->normal(x, y) = {};
  view->is_to_refine(x, y) = 0;
  --view->num_depths_to_refine;
  if (!view->min_cost.Empty()) {
    view->min_cost(x, y) = kUndefinedCost;
    view->second_cost(x, y) = kUndefinedCost;
  }
}

}  // namespace

bool IsUnfiltered(int64_t num_depths, int64_t num_pixels) {
  // Unfiltered maps lack little more than the margins; filters remove a tenth
  // to a half.
  constexpr double kMinShare = 0.98;
  return num_depths > 0 && static_cast<double>(num_depths) >=
                               kMinShare * static_cast<double>(num_pixels);
}

UnmatchedDepths::UnmatchedDepths(const ViewData& view, int num_sources)
    : view_(view),
      min_num_matches_(
          std::min(HypothesisFilterOptions().min_num_consistent, num_sources)),
      device_(Device::CreateCpu(1)),
      gray_(ComputeGray(view.color.View(), *device_).ToHost()),
      num_matches_(view.depth.Width(), view.depth.Height()) {}

void UnmatchedDepths::CompareWith(const ViewData& source) {
  const std::shared_ptr<const UploadedView> uploaded =
      UploadView(source, *device_);
  HypothesisFilterOptions options;
  options.min_num_consistent = min_num_matches_;
  AddDistinctMatches({view_.camera.GetIntrinsics(),
                      gray_.View(),
                      view_.depth.View(),
                      view_.normal.View()},
                     {source.camera.GetIntrinsics(),
                      ComputeRelativePose(view_.camera, source.camera),
                      uploaded->gray.View(),
                      uploaded->depth.View()},
                     options,
                     num_matches_.View(),
                     *device_);
}

void UnmatchedDepths::Drop(ViewData* view) const {
  for (int y = 0; y < num_matches_.Height(); ++y) {
    for (int x = 0; x < num_matches_.Width(); ++x) {
      if (view->is_to_refine(x, y) != 0 &&
          num_matches_(x, y) < min_num_matches_) {
        DropDepth(x, y, view);
      }
    }
  }
}

}  // namespace tsar
