// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/fill_under_prior.h"

#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/tools/stereo/stereo_views.h"

#include <algorithm>

namespace tsar {
namespace {

// A second one changes the clouds by 0.003 at most.
constexpr int kNumIterations = 1;
// One confirming view suffices here; fusion requires more.
constexpr int kMinNumConsistent = 1;

bool IsFilled(const ViewData& view, size_t pixel) {
  return view.depth.Data()[pixel] > 0.f &&
         view.min_cost.Data()[pixel] == kUndefinedCost;
}

// The planes of the filled pixels, invalid elsewhere.
Image<Plane> PriorOf(const ViewData& view, const Intrinsics& intrinsics) {
  Image<Plane> prior(view.depth.Width(), view.depth.Height());
  for (int y = 0; y < prior.Height(); ++y) {
    for (int x = 0; x < prior.Width(); ++x) {
      if (IsFilled(view, view.depth.View().Index(x, y))) {
        prior(x, y) = Plane::FromPoint(
            intrinsics.Ray(x, y), view.depth(x, y), view.normal(x, y));
      }
    }
  }
  return prior;
}

Image<uint8_t> PixelsThatKeepTheirPlane(const ViewData& view) {
  Image<uint8_t> keeps_plane(view.depth.Width(), view.depth.Height());
  for (size_t i = 0; i < keeps_plane.NumPixels(); ++i) {
    keeps_plane.Data()[i] = IsFilled(view, i) ? 0 : 1;
  }
  return keeps_plane;
}

// Merges the measured pixels of the view and the depth and normal of the filled
// ones.
StereoMaps Merge(const ViewData& view,
                 const Image<float>& depth,
                 const Image<Vec3f>& normal) {
  StereoMaps maps{view.depth, view.normal, view.min_cost, view.second_cost};
  for (size_t i = 0; i < depth.NumPixels(); ++i) {
    if (IsFilled(view, i)) {
      const bool is_kept = depth.Data()[i] > 0.f;
      maps.depth.Data()[i] = is_kept ? depth.Data()[i] : 0.f;
      maps.normal.Data()[i] = is_kept ? normal.Data()[i] : Vec3f{};
      maps.min_cost.Data()[i] = kCostWithoutEvidence;
      maps.second_cost.Data()[i] = kCostWithoutEvidence;
    }
  }
  return maps;
}

}  // namespace

void FillWithPrior(const Image<Plane>& prior,
                   const Intrinsics& intrinsics,
                   const DepthInterval& range,
                   StereoMaps* maps) {
  for (int y = 0; y < prior.Height(); ++y) {
    for (int x = 0; x < prior.Width(); ++x) {
      const Plane& plane = prior(x, y);
      if (maps->depth(x, y) > 0.f || !plane.Valid()) {
        continue;
      }
      const float depth = plane.Depth(intrinsics.Ray(x, y));
      if (depth >= range.min && depth <= range.max) {
        maps->depth(x, y) = depth;
        maps->normal(x, y) = plane.normal;
        maps->min_cost(x, y) = kUndefinedCost;
        maps->second_cost(x, y) = kUndefinedCost;
      }
    }
  }
}

StereoMaps MatchUnderPrior(const ViewData& reference,
                           const std::vector<const ViewData*>& sources,
                           const DepthInterval& range,
                           uint32_t stream,
                           const StereoOptions& options,
                           Device& device) {
  const StereoViews views(reference, sources, 1, device);
  const Buffer<SourceView> source_views = views.Sources(0);
  const ReferenceView view = views.Reference(0);
  PatchMatchOptions search = SearchOptions(options, range);
  search.num_past_iterations = options.num_iterations - 1;
  search.num_iterations = kNumIterations;
  const DeviceImage<Plane> prior(device, PriorOf(reference, view.intrinsics));
  const DeviceImage<uint8_t> keeps_plane(device,
                                         PixelsThatKeepTheirPlane(reference));
  PatchMatchInputs inputs{view, source_views, StreamOf(stream, kUnderPrior)};
  inputs.prior = prior.View();
  inputs.keeps_plane = keeps_plane.View();
  PlaneMaps maps = UpdateMaps(reference, inputs, search, device);
  HypothesisFilterOptions filter =
      FilterOptions(options, static_cast<int>(sources.size()));
  filter.min_num_consistent =
      std::min(filter.min_num_consistent, kMinNumConsistent);
  FilterMaps(inputs, filter, options.smooth_normals, device, &maps);
  return Merge(reference, maps.depth.ToHost(), maps.normal.ToHost());
}

}  // namespace tsar
