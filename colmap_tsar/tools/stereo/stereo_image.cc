// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_image.h"

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/plane_maps.h"
#include "colmap_tsar/tools/stereo/stereo_views.h"
#include "colmap_tsar/view/device_views.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

// Few iterations suffice, since a pass starts from good planes.
constexpr int kGeometricIterations = 2;

Image<float> WithoutUndefined(Image<float> costs) {
  for (float& cost : costs) {
    if (cost == kUndefinedCost) {
      cost = kCostWithoutEvidence;
    }
  }
  return costs;
}

StereoMaps ToHost(const DepthNormalImages& maps) {
  StereoMaps host;
  host.depth = maps.depth.ToHost();
  host.normal = maps.normal.ToHost();
  for (size_t i = 0; i < host.depth.NumPixels(); ++i) {
    if (!(host.depth.Data()[i] > 0.f)) {
      host.depth.Data()[i] = 0.f;
      host.normal.Data()[i] = {};
    }
  }
  return host;
}

StereoMaps ToHostWithCosts(ReferenceView reference,
                           const Buffer<SourceView>& sources,
                           const DepthNormalImages& maps,
                           Device& device) {
  reference.depth = maps.depth.View();
  reference.normal = maps.normal.View();
  const MatchingCosts costs = ComputeMatchingCosts(reference, sources, device);
  StereoMaps host = ToHost(maps);
  host.min_cost = WithoutUndefined(costs.min_cost.ToHost());
  host.second_cost = WithoutUndefined(costs.second_cost.ToHost());
  return host;
}

// The number of levels whose smaller side still holds a window.
int NumLevels(const StereoOptions& options, const Image<Rgb>& color) {
  int num_levels = 1;
  const int side = std::min(color.Width(), color.Height());
  while (num_levels < options.num_levels &&
         (side >> num_levels) > 4 * options.window_radius) {
    ++num_levels;
  }
  return num_levels;
}

// The mask (1) of pixels without depth.
Image<uint8_t> HolesOf(const Image<float>& depth) {
  auto holes = Image<uint8_t>::Uninitialized(depth.Width(), depth.Height());
  std::ranges::transform(
      depth, holes.begin(), [](float z) -> uint8_t { return z > 0.f ? 0 : 1; });
  return holes;
}

}  // namespace

StereoMaps MatchImage(const ViewData& reference,
                      const std::vector<const ViewData*>& sources,
                      const DepthInterval& range,
                      uint32_t stream,
                      const StereoOptions& options,
                      Device& device) {
  const PatchMatchOptions search = SearchOptions(options, range);
  const int num_levels = NumLevels(options, reference.color);
  const StereoViews views(reference, sources, num_levels, device);
  DeviceImage<Plane> planes;
  for (int level = num_levels - 1; level >= 0; --level) {
    const ReferenceView view = views.Reference(level);
    const Buffer<SourceView> level_sources = views.Sources(level);
    const int width = view.gray.width;
    const int height = view.gray.height;
    planes =
        planes.Empty()
            ? DrawPlanes(view.intrinsics,
                         width,
                         height,
                         StreamOf(stream, kFirstPlanes),
                         search,
                         device)
            : ResizePlanes(std::as_const(planes).View(), width, height, device);
    planes =
        RunPatchMatch({view, level_sources, StreamOf(stream, kLevels + level)},
                      std::move(planes),
                      search,
                      device)
            .planes;
  }
  const ReferenceView view = views.Reference(0);
  const DepthNormalImages maps =
      MapsFromPlanes(view.intrinsics, std::as_const(planes).View(), device);
  return ToHostWithCosts(view, views.Sources(0), maps, device);
}

StereoMaps MatchImageGeometrically(const ViewData& reference,
                                   const std::vector<const ViewData*>& sources,
                                   const DepthInterval& range,
                                   uint32_t stream,
                                   int pass,
                                   bool keeps_holes,
                                   const StereoOptions& options,
                                   Device& device) {
  const StereoViews views(reference, sources, 1, device);
  const Buffer<SourceView> level_sources = views.Sources(0);
  const ReferenceView view = views.Reference(0);
  PatchMatchOptions search = SearchOptions(options, range);
  search.num_past_iterations =
      options.num_iterations - 1 + pass * kGeometricIterations;
  search.num_iterations = kGeometricIterations;
  PatchMatchInputs inputs{
      view, level_sources, StreamOf(stream, kGeometricPasses + pass)};
  DeviceImage<uint8_t> holes;
  if (keeps_holes) {
    holes = DeviceImage<uint8_t>(device, HolesOf(reference.depth));
    inputs.keeps_plane = std::as_const(holes).View();
  }
  DepthNormalImages maps = UpdateMaps(reference, inputs, search, device);
  if (pass + 1 < options.num_geometric_passes) {
    return ToHost(maps);
  }
  FilterMaps(inputs,
             FilterOptions(options, static_cast<int>(sources.size())),
             options.smooth_normals,
             device,
             &maps);
  return ToHostWithCosts(view, level_sources, maps, device);
}

MemoryPlan PlanStereo(const WorkspaceOverview& overview) {
  const int64_t num_pixels = overview.max_num_pixels;
  MemoryPlan plan;
  plan.num_sources = overview.max_num_sources;
  // Measured, as are all factors (stereo_memory_test.cc). Each image uploads
  // its sources again.
  plan.device = (1 << 14) + num_pixels * (75 + 9 * plan.num_sources);
  plan.views = kViewBytesPerPixel * num_pixels * (plan.num_sources + 1);
  // The maps with their costs.
  plan.main = plan.views + ReadAndWriteBytes(overview) + 50 * num_pixels;
  return plan;
}

}  // namespace tsar
