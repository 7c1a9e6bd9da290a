// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/stage_memory.h"

#include "colmap_tsar/device/working_bytes.h"
#include "colmap_tsar/pipeline/compose_scene.h"
#include "colmap_tsar/pipeline/device_views.h"
#include "colmap_tsar/pipeline/fill_holes.h"
#include "colmap_tsar/pipeline/find_scene.h"
#include "colmap_tsar/pipeline/find_surfaces.h"
#include "colmap_tsar/pipeline/lay_cylinders.h"
#include "colmap_tsar/pipeline/lift_rating.h"
#include "colmap_tsar/pipeline/photometric_detail.h"
#include "colmap_tsar/pipeline/stage_options.h"
#include "colmap_tsar/scene_planes/choose_labels.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/foreground_fattening.h"
#include "colmap_tsar/scene_planes/gather_evidence.h"
#include "colmap_tsar/scene_planes/label_inputs.h"
#include "colmap_tsar/scene_planes/plane_costs.h"
#include "colmap_tsar/scene_planes/refine_borders.h"
#include "colmap_tsar/superpixels/slic.h"

#include <algorithm>

namespace tsar {
namespace {

// What a view brings where planes of the scene are looked for: those that it
// found, at most DiscoverPlanesOptions::max_planes, and those of its regions,
// of which there are seldom more than this.
constexpr int kCandidatesOfRegions = 60;

// The superpixels that a raster has as a rule: what is smaller than a quarter
// of superpixel_size was merged, and what is left at the borders of objects is
// smaller than superpixel_size. Where many views add up, the most that each of
// them can have would be far too much.
int64_t NumSuperpixels(const RefineOptions& options, int64_t num_pixels) {
  return MaxRasterPixels(num_pixels) * 3 / 2 / options.superpixel_size + 1;
}

DiscoverySize SizeOfDiscovery(const RefineOptions& options,
                              int64_t num_pixels,
                              int num_views) {
  DiscoverySize size;
  size.num_views = num_views;
  size.num_superpixels = num_views * NumSuperpixels(options, num_pixels);
  size.num_observations =
      num_views * MaxObservations(MaxRasterPixels(num_pixels),
                                  NumSuperpixels(options, num_pixels),
                                  {});
  size.num_candidates =
      int64_t{num_views} *
      (kCandidatesOfRegions + DiscoverPlanesOptions().max_planes);
  return size;
}

LabelingSize SizeOfLabeling(const RefineOptions& options,
                            int64_t num_pixels,
                            int num_views) {
  LabelingSize size;
  size.num_views = num_views;
  size.num_pixels = MaxRasterPixels(num_pixels);
  size.num_superpixels = NumSuperpixels(options, num_pixels);
  size.num_observations =
      MaxObservations(size.num_pixels, size.num_superpixels, {});
  // As many as one view can have, and as many more by its sources.
  size.num_planes = 2 * DiscoverPlanesOptions().max_planes;
  return size;
}

// The confidence of a composed map and, before it is downloaded, the sigma of
// its depths; the provenance is there by then.
int64_t ConfidenceBytes(const RefineOptions& options, int64_t num_pixels) {
  return BytesOf<float>(num_pixels) +
         (options.sigma_maps ? BytesOf<uint16_t>(num_pixels) : 0);
}

}  // namespace

int64_t RefineImageWorkingBytes(const RefineOptions& options,
                                int64_t num_pixels,
                                int num_sources) {
  const int64_t plane_image = options.superpixel_planes && options.refine
                                  ? BytesOf<Plane>(MaxRasterPixels(num_pixels))
                                  : 0;
  const int64_t provenance = BytesOf<uint8_t>(num_pixels);
  // With fill_before_regions, FindSurfaces() does these.
  const int64_t filling = options.fill_before_regions
                              ? 0
                              : plane_image + provenance +
                                    FillHolesWorkingBytes(options, num_pixels);
  const int64_t rating =
      (options.fill_before_regions ? 0 : plane_image + provenance) +
      ConfidenceBytes(options, num_pixels);
  const int64_t composing = DeviceViewsBytesWithoutSources(num_pixels) +
                            SurfacesBytes(options, num_pixels) +
                            std::max(filling, rating);
  return std::max({MakeDeviceViewsWorkingBytes(num_pixels, options.denoise),
                   FindSurfacesWorkingBytes(options, num_pixels, num_sources),
                   composing});
}

int64_t MeasureImageWorkingBytes(const RefineOptions& options,
                                 int64_t num_pixels,
                                 int num_sources) {
  const int64_t num_raster_pixels = MaxRasterPixels(num_pixels);
  const int64_t gray = BytesOf<float>(num_raster_pixels);
  const int64_t samples = BytesOf<RayDepth>(num_raster_pixels);
  const int64_t ratings = BytesOf<uint8_t>(num_pixels);
  const int64_t downloading =
      DeviceViewsBytesWithoutSources(num_pixels) +
      SurfacesBytes(MeasuringOptions(options), num_pixels) + gray +
      std::max(samples, ratings);
  return std::max({MakeDeviceViewsWorkingBytes(num_pixels, options.denoise),
                   FindSurfacesWorkingBytes(
                       MeasuringOptions(options), num_pixels, num_sources),
                   downloading});
}

int64_t ComposeImageWorkingBytes(const RefineOptions& options,
                                 int64_t num_pixels,
                                 int64_t num_judged_pixels,
                                 int num_sources) {
  const int64_t num_raster_pixels = MaxRasterPixels(num_judged_pixels);
  const int64_t num_superpixels =
      MaxSuperpixels(num_raster_pixels, options.superpixel_size);
  // Each superpixel of a curved surface has a plane.
  const int64_t num_planes =
      num_superpixels + DiscoverPlanesOptions().max_planes;
  const int64_t superpixels = BytesOf<uint16_t>(num_raster_pixels);
  const int64_t color = BytesOf<Rgb>(num_raster_pixels);
  const int64_t lab = BytesOf<Vec3f>(num_raster_pixels);
  const int64_t borders =
      options.pixel_borders
          ? superpixels + lab +
                std::max(color,
                         RefineBordersWorkingBytes(
                             num_raster_pixels, num_superpixels, num_planes))
          : 0;
  const int64_t planes_of_scene_and_regions =
      2 * BytesOf<Plane>(num_raster_pixels);
  const int64_t of_superpixel = BytesOf<ComposedSuperpixel>(num_superpixels);
  const int64_t provenance = BytesOf<uint8_t>(num_pixels);
  const int64_t plane_maps = BytesOf<uint16_t>(num_raster_pixels + num_pixels);
  // Of a map that is judged as it is.
  const int64_t confidence_and_detail =
      options.photometric
          ? BytesOf<float>(num_judged_pixels) +
                BytesOf<uint16_t>(num_raster_pixels) +
                RestoreDetailWorkingBytes(
                    num_judged_pixels,
                    std::min(num_sources, kMaxPhotometricSources))
          : 0;
  const int64_t cylinders =
      options.cylinders ? LaidCylindersBytes(num_pixels) : 0;
  const int64_t composing =
      planes_of_scene_and_regions + superpixels + of_superpixel + cylinders +
      std::max(ComposeSceneWorkingBytes(num_pixels),
               provenance +
                   std::max({FillHolesWorkingBytes(options, num_pixels),
                             ConfidenceBytes(options, num_pixels) + plane_maps,
                             confidence_and_detail}));
  const int64_t ratings = BytesOf<uint8_t>(num_pixels);
  return DeviceReferenceWorkingBytes(num_pixels) +
         std::max(LiftRatingsWorkingBytes(num_pixels, num_judged_pixels),
                  ratings + std::max(borders, composing));
}

int64_t MakeEvidenceMainBytes(const RefineOptions& options,
                              int64_t num_pixels) {
  const int64_t num_raster_pixels = MaxRasterPixels(num_pixels);
  const int64_t num_superpixels = NumSuperpixels(options, num_pixels);
  // Each superpixel that has a plane is a candidate.
  DiscoverySize size = SizeOfDiscovery(options, num_pixels, 1);
  size.num_candidates = num_superpixels + kCandidatesOfRegions;
  const int64_t fattening_weights =
      options.foreground_fattening ? BytesOf<float>(num_raster_pixels) : 0;
  return std::max(
      options.foreground_fattening
          ? ForegroundFatteningMainBytes(num_raster_pixels)
          : 0,
      fattening_weights +
          std::max(
              GatherEvidenceMainBytes(num_raster_pixels, num_superpixels, {}),
              EvidenceBytes(num_raster_pixels, num_superpixels, {}) +
                  DiscoverPlanesWorkingBytes(size, {}) +
                  DiscoverPlanesMainBytes(size, {})));
}

int64_t ModelBlockMainBytes(const RefineOptions& options,
                            int64_t num_pixels,
                            int num_views) {
  const DiscoverPlanesOptions discovery = BlockDiscoveryOptions({}, num_views);
  const DiscoverySize size = SizeOfDiscovery(options, num_pixels, num_views);
  return DiscoverPlanesWorkingBytes(size, discovery) +
         DiscoverPlanesMainBytes(size, discovery);
}

int64_t LabelViewWorkingBytes(const RefineOptions& options,
                              int64_t num_pixels,
                              int num_views) {
  return LabelInModelWorkingBytes(
      SizeOfLabeling(options, num_pixels, num_views),
      {/*confident_depth=*/true, /*superpixels=*/true});
}

int64_t LabelViewMainBytes(const RefineOptions& options,
                           int64_t num_pixels,
                           int num_views) {
  const LabelingSize size = SizeOfLabeling(options, num_pixels, num_views);
  const int64_t num_costs = size.num_superpixels * size.num_planes;
  return BytesOf<PlaneCost>(num_costs) + BytesOf<float>(num_costs) +
         std::max(LabelViewWorkingBytes(options, num_pixels, num_views),
                  ChooseLabelsMainBytes(size.num_superpixels, size.num_planes));
}

int64_t MeasuredImageBytes(const RefineOptions& options, int64_t num_pixels) {
  const int64_t num_raster_pixels = MaxRasterPixels(num_pixels);
  const int64_t superpixels =
      BytesOf<int>(num_raster_pixels) +
      BytesOf<Plane>(NumSuperpixels(options, num_pixels));
  // The trusted ones and the confirmed ones.
  const int64_t samples = 2 * BytesOf<RayDepth>(num_raster_pixels);
  const int64_t region_planes = BytesOf<Plane>(num_raster_pixels);
  const int64_t color = BytesOf<Rgb>(num_raster_pixels);
  const int64_t gray_texture_contrast = 3 * BytesOf<float>(num_raster_pixels);
  const int64_t ratings = BytesOf<uint8_t>(num_pixels);
  return superpixels + samples + region_planes + color + gray_texture_contrast +
         ratings;
}

int64_t ViewEvidenceBytes(const RefineOptions& options, int64_t num_pixels) {
  const int64_t num_raster_pixels = MaxRasterPixels(num_pixels);
  const int64_t color = BytesOf<Rgb>(num_raster_pixels);
  const int64_t ratings = BytesOf<uint8_t>(num_pixels);
  return EvidenceBytes(
             num_raster_pixels, NumSuperpixels(options, num_pixels), {}) +
         color + ratings;
}

int64_t NeighbourEvidenceBytes(const RefineOptions& options,
                               int64_t num_pixels) {
  return EvidenceForNeighboursBytes(
      MaxRasterPixels(num_pixels), NumSuperpixels(options, num_pixels), {});
}

}  // namespace tsar
