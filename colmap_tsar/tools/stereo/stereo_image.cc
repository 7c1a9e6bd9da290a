// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_image.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/plane_maps.h"
#include "colmap_tsar/matching/views.h"
#include "colmap_tsar/view/device_views.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

// Few iterations suffice, since a pass starts from good planes.
constexpr int kGeometricIterations = 2;

// The uses of random numbers in an image, each with numbers of its own.
constexpr int kFirstPlanes = 0;
constexpr int kLevels = 1;              // Plus the level.
constexpr int kGeometricPasses = 1000;  // Plus the pass.

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

// The image at levels of half the previous size each, from half of `image` on.
std::vector<GrayTexture> HalvedLevels(const GrayTexture& image,
                                      int num_levels,
                                      Device& device) {
  std::vector<GrayTexture> levels;
  for (int level = 1; level < num_levels; ++level) {
    const GrayTexture& last = levels.empty() ? image : levels.back();
    levels.push_back(HalveGray(last.View(), device));
  }
  return levels;
}

// An image and its sources in a device's memory, at the size of their views
// (level 0) and at levels of half the previous size each.
class StereoViews {
 public:
  // Holds references to the sources and the device.
  StereoViews(const ViewData& reference,
              const UploadedSources& sources,
              int num_levels,
              Device& device)
      : device_(device),
        camera_(reference.camera),
        gray_(ComputeGrayTexture(
            DeviceImage<Rgb>(device, reference.color).View(), device)),
        halved_(HalvedLevels(gray_, num_levels, device)),
        sources_(sources),
        synchronization_(device) {
    for (const auto& source : sources_) {
      halved_sources_.push_back(HalvedLevels(source->gray, num_levels, device));
    }
  }

  // The reference without depth and normal.
  ReferenceView Reference(int level) const {
    const GrayTexture& gray = level == 0 ? gray_ : halved_[level - 1];
    return {LevelIntrinsics(camera_, level), gray.View(), {}, {}};
  }

  // The sources, with depth at level 0 if the views have it.
  SourceViews Sources(int level) const {
    std::vector<SourceView> views;
    for (size_t i = 0; i < sources_.size(); ++i) {
      const UploadedView& source = *sources_[i];
      views.push_back(
          {LevelIntrinsics(source.camera, level),
           ComputeRelativePose(camera_, source.camera),
           level == 0 ? source.gray.View()
                      : halved_sources_[i][level - 1].View(),
           level == 0 ? source.depth.View() : ImageView<const float>{}});
    }
    return SourceViews(device_, std::move(views));
  }

 private:
  Device& device_;
  const Camera camera_;
  const GrayTexture gray_;
  const std::vector<GrayTexture> halved_;  // From level 1 on.
  const UploadedSources& sources_;
  std::vector<std::vector<GrayTexture>> halved_sources_;
  // Waits for work that may read the sources, see UploadedViews.
  const ScopedSynchronization synchronization_;
};

PatchMatchOptions SearchOptions(const StereoOptions& options,
                                const DepthInterval& range) {
  PatchMatchOptions search;
  search.num_iterations = options.num_iterations;
  search.window_radius = static_cast<float>(options.window_radius);
  search.depth_min = static_cast<float>(range.min);
  search.depth_max = static_cast<float>(range.max);
  return search;
}

// The key of the random numbers of one use. image_stream: the image's key.
uint32_t StreamOf(uint32_t image_stream, int use) {
  return image_stream + static_cast<uint32_t>(use) * 0x9E3779B9u;
}

// Runs PatchMatch from the depth and normal of `view`, those of the previous
// pass. inputs: those with this view as reference.
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

// The options of the filter for an image with num_sources sources.
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

// Filters the depths of the reference and, with smooth_normals, its normals.
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
                           const SourceViews& sources,
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
                      const UploadedSources& sources,
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
    const SourceViews level_sources = views.Sources(level);
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
                                   const UploadedSources& sources,
                                   const DepthInterval& range,
                                   uint32_t stream,
                                   int pass,
                                   bool keeps_holes,
                                   const StereoOptions& options,
                                   Device& device) {
  const StereoViews views(reference, sources, 1, device);
  const SourceViews level_sources = views.Sources(0);
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

StereoMaps FilterImage(const ViewData& reference,
                       const UploadedSources& sources,
                       const StereoOptions& options,
                       Device& device) {
  const StereoViews views(reference, sources, 1, device);
  const SourceViews level_sources = views.Sources(0);
  DepthNormalImages maps;
  maps.depth = DeviceImage<float>(device, reference.depth);
  maps.normal = DeviceImage<Vec3f>(device, reference.normal);
  FilterMaps({views.Reference(0), level_sources, 0},
             FilterOptions(options, static_cast<int>(sources.size())),
             /*smooth_normals=*/false,
             device,
             &maps);
  return ToHost(maps);
}

MemoryPlan PlanStereo(const WorkspaceOverview& overview) {
  const int64_t num_pixels = overview.max_num_pixels;
  MemoryPlan plan;
  plan.num_sources = overview.max_num_sources;
  // Measured, as are all factors (stereo_memory_test.cc).
  plan.device = (1 << 14) + num_pixels * (75 + 9 * plan.num_sources);
  plan.views = kViewBytesPerPixel * num_pixels * (plan.num_sources + 1);
  // The maps with their costs.
  plan.main = plan.views + ReadAndWriteBytes(overview) + 50 * num_pixels;
  return plan;
}

}  // namespace tsar
