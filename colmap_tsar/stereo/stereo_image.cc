// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/stereo/stereo_image.h"

#include "colmap_tsar/device/working_bytes.h"
#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/plane_maps.h"
#include "colmap_tsar/matching/smooth_normals.h"
#include "colmap_tsar/pipeline/gray.h"
#include "colmap_tsar/stereo/planar_prior.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

// A pass updates planes that are good already.
constexpr int kGeometricIterations = 2;

// A view on the device, in all sizes from its own on.
class Pyramid {
 public:
  Pyramid(const ViewData& view, int num_levels, Device& device)
      : camera_(view.camera) {
    const DeviceImage<Rgb> color(device, view.color);
    grays_.push_back(ComputeGray(color.View(), device));
    intrinsics_.push_back(view.camera.GetIntrinsics());
    for (int level = 1; level < num_levels; ++level) {
      grays_.push_back(HalveGray(Gray(level - 1), device));
      // Pixel x of the half image lies between 2 x and 2 x + 1.
      Intrinsics half = intrinsics_.back();
      half.fx *= 0.5f;
      half.fy *= 0.5f;
      half.cx = (half.cx - 0.5f) * 0.5f;
      half.cy = (half.cy - 0.5f) * 0.5f;
      intrinsics_.push_back(half);
    }
    if (!view.depth.Empty()) {
      depth_ = DeviceImage<float>(device, view.depth);
    }
  }

  ImageView<const float> Gray(int level) const {
    return grays_[static_cast<size_t>(level)].View();
  }
  const Intrinsics& LevelIntrinsics(int level) const {
    return intrinsics_[static_cast<size_t>(level)];
  }
  ImageView<const float> Depth() const {
    return depth_.Empty() ? ImageView<const float>{} : depth_.View();
  }
  const Camera& GetCamera() const { return camera_; }

 private:
  Camera camera_;
  std::vector<DeviceImage<float>> grays_;
  std::vector<Intrinsics> intrinsics_;
  DeviceImage<float> depth_;
};

// The reference and its sources on the device.
class StereoViews {
 public:
  StereoViews(const ViewData& reference,
              const std::vector<const ViewData*>& sources,
              int num_levels,
              Device& device)
      : device_(device), reference_(reference, num_levels, device) {
    for (const ViewData* source : sources) {
      sources_.emplace_back(*source, num_levels, device);
    }
  }

  ReferenceView Reference(int level) const {
    return {reference_.LevelIntrinsics(level), reference_.Gray(level), {}, {}};
  }

  Buffer<SourceView> Sources(int level) const {
    std::vector<SourceView> views;
    for (const Pyramid& source : sources_) {
      views.push_back(
          {source.LevelIntrinsics(level),
           ComputeRelativePose(reference_.GetCamera(), source.GetCamera()),
           source.Gray(level),
           level == 0 ? source.Depth() : ImageView<const float>{}});
    }
    return Buffer<SourceView>(device_, views);
  }

 private:
  Device& device_;
  Pyramid reference_;
  std::vector<Pyramid> sources_;
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

// Every draw site of an image has a stream of its own.
uint32_t StreamOf(uint32_t image_stream, int site) {
  return image_stream + static_cast<uint32_t>(site) * 0x9E3779B9u;
}

// In files, which have no other word for it.
constexpr float kCostWithoutEvidence = 2.f;

Image<float> WithoutUndefined(Image<float> costs) {
  for (float& cost : costs) {
    if (cost == kUndefinedCost) {
      cost = kCostWithoutEvidence;
    }
  }
  return costs;
}

// Whoever reads the maps shall not take what follows from the prior for
// measured.
void RemoveEvidence(const Image<uint8_t>& follows_prior, StereoMaps* maps) {
  for (size_t i = 0; i < follows_prior.NumPixels(); ++i) {
    if (follows_prior.Data()[i] != 0) {
      maps->min_cost.Data()[i] = kCostWithoutEvidence;
      maps->second_cost.Data()[i] = kCostWithoutEvidence;
    }
  }
}

StereoMaps ToHost(const PlaneMaps& maps) {
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
                           const PlaneMaps& maps,
                           Device& device) {
  reference.depth = maps.depth.View();
  reference.normal = maps.normal.View();
  const MatchingCosts costs = ComputeMatchingCosts(reference, sources, device);
  StereoMaps host = ToHost(maps);
  host.min_cost = WithoutUndefined(costs.min_cost.ToHost());
  host.second_cost = WithoutUndefined(costs.second_cost.ToHost());
  return host;
}

// As many as leave the smaller side of the image room for a window.
int NumLevels(const StereoOptions& options, const Image<Rgb>& color) {
  int num_levels = 1;
  const int side = std::min(color.Width(), color.Height());
  while (num_levels < options.num_levels &&
         (side >> num_levels) > 4 * options.window_radius) {
    ++num_levels;
  }
  return num_levels;
}

// Images of all levels: each holds a quarter of the pixels of the one before,
// or less.
int64_t PyramidBytes(int64_t num_pixels, int num_levels) {
  int64_t num_bytes = 0;
  for (int level = 0; level < num_levels; ++level) {
    num_bytes += BytesOf<float>(num_pixels >> (2 * level));
  }
  return num_bytes;
}

// The depth and normal that planes stand for.
int64_t PlaneMapsBytes(int64_t num_pixels) {
  return BytesOf<float>(num_pixels) + BytesOf<Vec3f>(num_pixels);
}

int64_t MatchingCostsBytes(int64_t num_pixels) {
  return 3 * BytesOf<float>(num_pixels);
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
                         StreamOf(stream, 0),
                         search,
                         device)
            : ResizePlanes(std::as_const(planes).View(), width, height, device);
    planes = RunPatchMatch({view, level_sources, StreamOf(stream, 1 + level)},
                           std::move(planes),
                           search,
                           device)
                 .planes;
  }
  const ReferenceView view = views.Reference(0);
  const PlaneMaps maps =
      MapsFromPlanes(view.intrinsics, std::as_const(planes).View(), device);
  return ToHostWithCosts(view, views.Sources(0), maps, device);
}

StereoMaps MatchImageGeometrically(const ViewData& reference,
                                   const std::vector<const ViewData*>& sources,
                                   const DepthInterval& range,
                                   uint32_t stream,
                                   int pass,
                                   const StereoOptions& options,
                                   Device& device) {
  const StereoViews views(reference, sources, 1, device);
  const Buffer<SourceView> level_sources = views.Sources(0);
  ReferenceView view = views.Reference(0);
  PatchMatchOptions search = SearchOptions(options, range);
  search.num_past_iterations =
      options.num_iterations - 1 + pass * kGeometricIterations;
  search.num_iterations = kGeometricIterations;
  PlaneMaps maps;
  DeviceImage<Plane> prior;
  {
    const DeviceImage<float> depth(device, reference.depth);
    const DeviceImage<Vec3f> normal(device, reference.normal);
    if (options.planar_prior) {
      view.depth = depth.View();
      view.normal = normal.View();
      prior =
          FindPlanarPrior(view, level_sources, search.window_radius, device);
    }
    const PlaneHypotheses found = RunPatchMatch(
        {view,
         level_sources,
         StreamOf(stream, 1000 + pass),
         std::as_const(prior).View()},
        PlanesFromMaps(view.intrinsics, depth.View(), normal.View(), device),
        search,
        device);
    maps = MapsFromPlanes(view.intrinsics, found.planes.View(), device);
  }
  if (pass + 1 < options.num_geometric_passes) {
    return ToHost(maps);
  }
  HypothesisFilterOptions filter;
  filter.min_ncc = static_cast<float>(options.filter_min_ncc);
  filter.min_triangulation_angle =
      static_cast<float>(options.filter_min_triangulation_angle);
  filter.min_num_consistent = std::min(options.filter_min_num_consistent,
                                       static_cast<int>(sources.size()));
  filter.geom_consistency_max_cost =
      static_cast<float>(options.filter_geom_consistency_max_cost);
  filter.window_radius = search.window_radius;
  view.depth = std::as_const(maps.depth).View();
  view.normal = std::as_const(maps.normal).View();
  DepthsUnderPrior filtered = FilterUnderPrior(
      view, level_sources, std::as_const(prior).View(), filter, device);
  prior = {};
  maps.depth = std::move(filtered.depth);
  if (options.smooth_normals) {
    maps.normal = SmoothNormals(view.intrinsics,
                                std::as_const(maps.depth).View(),
                                std::as_const(maps.normal).View(),
                                {},
                                device);
  }
  StereoMaps host = ToHostWithCosts(view, level_sources, maps, device);
  if (!filtered.follows_prior.Empty()) {
    RemoveEvidence(filtered.follows_prior.ToHost(), &host);
  }
  return host;
}

int64_t MatchImageWorkingBytes(const StereoOptions& options,
                               int64_t num_pixels,
                               int num_sources) {
  const int64_t views =
      (num_sources + 1) * PyramidBytes(num_pixels, options.num_levels) +
      BytesOf<SourceView>(num_sources);
  const int64_t color = BytesOf<Rgb>(num_pixels);
  const int64_t planes = BytesOf<Plane>(num_pixels);
  const int64_t smaller_planes = BytesOf<Plane>(num_pixels / 4);
  return views +
         std::max({color,
                   planes + smaller_planes,
                   planes + RunPatchMatchWorkingBytes(num_pixels, num_sources),
                   planes + PlaneMapsBytes(num_pixels) +
                       MatchingCostsBytes(num_pixels)});
}

int64_t MatchImageGeometricallyWorkingBytes(const StereoOptions& options,
                                            int64_t num_pixels,
                                            int num_sources) {
  const int64_t gray_and_depth = 2 * BytesOf<float>(num_pixels);
  const int64_t views =
      (num_sources + 1) * gray_and_depth + BytesOf<SourceView>(num_sources);
  const int64_t maps = PlaneMapsBytes(num_pixels);
  const int64_t planes = BytesOf<Plane>(num_pixels);
  const int64_t found = planes + BytesOf<float>(num_pixels);
  // The prior's plane of each pixel; in the end, whether a depth follows it.
  const int64_t prior =
      options.planar_prior ? planes + BytesOf<uint8_t>(num_pixels) : 0;
  const int64_t finding_prior =
      options.planar_prior ? FindPlanarPriorWorkingBytes(num_pixels) : 0;
  // Maps go in and, smoothed or not, come out.
  const int64_t matching =
      maps + std::max({finding_prior,
                       prior + planes +
                           RunPatchMatchWorkingBytes(num_pixels, num_sources),
                       prior + found + maps});
  const int64_t smoothed_normals = BytesOf<Vec3f>(num_pixels);
  return views + std::max(matching,
                          maps + prior +
                              std::max(smoothed_normals,
                                       MatchingCostsBytes(num_pixels)));
}

int64_t StereoMapsBytes(int64_t num_pixels) {
  return PlaneMapsBytes(num_pixels) + 2 * BytesOf<float>(num_pixels);
}

}  // namespace tsar
