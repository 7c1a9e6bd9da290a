// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_views.h"

#include "colmap_tsar/matching/gray_pair.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

Intrinsics LevelIntrinsics(const Camera& camera, int level) {
  Intrinsics intrinsics = camera.GetIntrinsics();
  for (int i = 0; i < level; ++i) {
    // Pixel x of the half image lies between 2 x and 2 x + 1.
    intrinsics.fx *= 0.5f;
    intrinsics.fy *= 0.5f;
    intrinsics.cx = (intrinsics.cx - 0.5f) * 0.5f;
    intrinsics.cy = (intrinsics.cy - 0.5f) * 0.5f;
  }
  return intrinsics;
}

// Makes the image at all levels.
std::vector<DeviceImage<float>> MakePyramid(const Image<Rgb>& color,
                                            int num_levels,
                                            Device& device) {
  std::vector<DeviceImage<float>> grays;
  const DeviceImage<Rgb> on_device(device, color);
  grays.push_back(ComputeGray(on_device.View(), device));
  for (int level = 1; level < num_levels; ++level) {
    grays.push_back(HalveGray(std::as_const(grays.back()).View(), device));
  }
  return grays;
}

}  // namespace

StereoViews::StereoViews(const ViewData& reference,
                         const std::vector<const ViewData*>& sources,
                         int num_levels,
                         Device& device)
    : device_(device),
      camera_(reference.camera),
      grays_(MakePyramid(reference.color, num_levels, device)) {
  for (const ViewData* view : sources) {
    Source& source = sources_.emplace_back();
    source.camera = view->camera;
    for (const DeviceImage<float>& gray :
         MakePyramid(view->color, num_levels, device)) {
      source.grays.push_back(PairGray(gray.View(), device));
    }
    if (!view->depth.Empty()) {
      source.depth = DeviceImage<float>(device, view->depth);
    }
  }
}

ReferenceView StereoViews::Reference(int level) const {
  return {LevelIntrinsics(camera_, level), grays_[level].View(), {}, {}};
}

Buffer<SourceView> StereoViews::Sources(int level) const {
  std::vector<SourceView> views;
  for (const Source& source : sources_) {
    const bool has_depth = level == 0 && !source.depth.Empty();
    views.push_back(
        {LevelIntrinsics(source.camera, level),
         ComputeRelativePose(camera_, source.camera),
         source.grays[level].View(),
         has_depth ? source.depth.View() : ImageView<const float>{}});
  }
  return Buffer<SourceView>(device_, views);
}

PatchMatchOptions SearchOptions(const StereoOptions& options,
                                const DepthInterval& range) {
  PatchMatchOptions search;
  search.num_iterations = options.num_iterations;
  search.window_radius = static_cast<float>(options.window_radius);
  search.depth_min = static_cast<float>(range.min);
  search.depth_max = static_cast<float>(range.max);
  return search;
}

uint32_t StreamOf(uint32_t image_stream, int use) {
  return image_stream + static_cast<uint32_t>(use) * 0x9E3779B9u;
}

DepthNormalImages UpdateMaps(const ViewData& view,
                             const PatchMatchInputs& inputs,
                             const PatchMatchOptions& search,
                             Device& device) {
  const Intrinsics& intrinsics = inputs.reference.intrinsics;
  const DeviceImage<float> depth(device, view.depth);
  const DeviceImage<Vec3f> normal(device, view.normal);
  const PlaneHypotheses found = RunPatchMatch(
      inputs,
      PlanesFromMaps(intrinsics, depth.View(), normal.View(), device),
      search,
      device);
  return MapsFromPlanes(intrinsics, found.planes.View(), device);
}

HypothesisFilterOptions FilterOptions(const StereoOptions& options,
                                      int num_sources) {
  HypothesisFilterOptions filter;
  filter.min_ncc = static_cast<float>(options.filter_min_ncc);
  filter.min_triangulation_angle =
      static_cast<float>(options.filter_min_triangulation_angle);
  filter.min_num_consistent =
      std::min(options.filter_min_num_consistent, num_sources);
  filter.geom_consistency_max_cost =
      static_cast<float>(options.filter_geom_consistency_max_cost);
  filter.window_radius = static_cast<float>(options.window_radius);
  return filter;
}

void FilterMaps(const PatchMatchInputs& inputs,
                const HypothesisFilterOptions& filter,
                bool smooth_normals,
                Device& device,
                DepthNormalImages* maps) {
  ReferenceView view = inputs.reference;
  view.depth = std::as_const(maps->depth).View();
  view.normal = std::as_const(maps->normal).View();
  maps->depth = FilterHypotheses(view, inputs.sources, filter, device);
  if (smooth_normals) {
    maps->normal = SmoothNormals(view.intrinsics,
                                 std::as_const(maps->depth).View(),
                                 std::as_const(maps->normal).View(),
                                 device);
  }
}

}  // namespace tsar
