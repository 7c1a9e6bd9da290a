// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/refine_image.h"

#include "colmap_tsar/compose/compose_map.h"
#include "colmap_tsar/compose/depth_sigma.h"
#include "colmap_tsar/compose/upsample_depth_flags.h"
#include "colmap_tsar/matching/bilateral_ncc.cuh"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/priors/align_normals.h"
#include "colmap_tsar/scene/evidence/foreground_fattening.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"
#include "colmap_tsar/scene/evidence/texture_measures.h"
#include "colmap_tsar/scene/scene_options.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/single_view.h"
#include "colmap_tsar/view/stage_timer.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace tsar {
namespace {

Image<uint8_t> RoundedGray(const Image<Rgb>& color) {
  Image<uint8_t> gray(color.Width(), color.Height());
  std::ranges::transform(color, gray.begin(), [](const Rgb& pixel) {
    return static_cast<uint8_t>(std::lround(GrayLevel(pixel)));
  });
  return gray;
}

// The least gain of a plane in one view to be a candidate in its neighbors,
// relative to that in all of them.
constexpr double kShareOfOneView = 0.25;

// The radius on the raster of the windows in which views are judged.
int PatchRadius(const Image<float>& raster, const Camera& camera) {
  return static_cast<int>(
      std::lround(double{kPatchRadius} * raster.Width() / camera.width));
}

EvidenceInputs DownloadInputs(const DeviceViews& views,
                              const SingleViewResult& single_view,
                              ImageView<const float> gray,
                              Device& device) {
  EvidenceInputs inputs;
  inputs.superpixels = single_view.superpixels.labels.ToHost();
  inputs.num_superpixels = single_view.superpixels.count;
  inputs.superpixel_planes = single_view.superpixel_planes.ToHost();
  // Planes are missing without RefineOptions::superpixel_planes.
  inputs.superpixel_planes.resize(static_cast<size_t>(inputs.num_superpixels));
  const auto sample = [&](ImageView<const uint8_t> wanted) {
    return SampleMeasurements(views.Hypotheses().depth,
                              single_view.score.View(),
                              wanted,
                              views.MapIntrinsics(),
                              views.Raster(),
                              device)
        .ToHost();
  };
  inputs.samples = sample(single_view.trusted.View());
  if (!single_view.confirmations.Empty()) {
    inputs.confirmed_samples = sample(single_view.confirmations.View());
  }
  if (!single_view.region_planes.Empty()) {
    inputs.region_planes = single_view.region_planes.ToHost();
  }
  inputs.texture = ComputeTexture(gray, device).ToHost();
  inputs.contrast = ComputeContrast(gray, device).ToHost();
  inputs.intrinsics = views.RasterIntrinsics();
  inputs.resolution = views.Scale();
  return inputs;
}

// Keeps only those candidate planes of superpixels that explain the whole view:
// most of the hundreds are duplicates, and every neighbor would have to score
// each of them.
void ReduceCandidates(const Camera& camera,
                      const RefineOptions& options,
                      Device& device,
                      GatheredEvidence* gathered) {
  ViewEvidence* evidence = &gathered->evidence;
  const std::vector<ObservedView> views = {MakeObservedView(*evidence, camera)};
  DiscoverPlanesOptions discovery = MakeSceneOptions(options, views).discovery;
  discovery.min_gain *= kShareOfOneView;
  const DiscoveredPlanes discovered =
      DiscoverPlanes(views, CollectCandidates(views), discovery, device);
  evidence->candidates.resize(static_cast<size_t>(gathered->num_region_planes));
  for (const ScenePlane& plane : discovered.planes) {
    const Plane candidate = ToCameraPlane(plane.plane, views[0].camera);
    if (candidate.Valid()) {
      evidence->candidates.push_back(candidate);
    }
  }
}

}  // namespace

std::string ReasonToKeep(const RefinedMaps& maps,
                         const RefineOptions& options) {
  return options.min_confidence <= 0.0 && !HasDepth(maps.depth)
             ? kNothingReliable
             : "";
}

RefineResult RefineImage(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    uint32_t image_id,
    const RefineOptions& options,
    Device& device) {
  RefineResult result;
  StageTimer timer(device, &result.seconds);
  DeviceViews views(reference, std::move(sources), device, options.denoise);
  timer.Finish("upload");
  const SingleViewResult single_view =
      RunSingleViewStages(reference, image_id, options, &views, device, &timer);
  DeviceImage<Plane> superpixel_planes;
  if (options.superpixel_planes && single_view.superpixels.count > 0) {
    superpixel_planes = PlanesOfLabels(single_view.superpixels.labels.View(),
                                       single_view.superpixel_planes,
                                       device);
  }
  ComposedMap composed = ComposeMap(std::move(views.hypotheses),
                                    {single_view.trusted.View(),
                                     views.OnMap(superpixel_planes),
                                     views.OnMap(single_view.region_planes),
                                     single_view.confirmations.View()},
                                    views.Scale(),
                                    device);
  FillHoles(views.Color(),
            views.MapIntrinsics(),
            options,
            options.num_iterations,
            &composed,
            device);
  const DeviceImage<float> confidence =
      ComputeComposedConfidence(composed, single_view.score.View(), device);
  const DeviceImage<uint8_t> levels =
      FinishMap(static_cast<float>(options.min_confidence),
                views.MapIntrinsics(),
                confidence.View(),
                &composed,
                device);
  if (options.sigma_maps) {
    result.maps.sigma =
        ComputeSigma(composed, views.Scale(), {}, device).ToHost();
  }
  timer.Finish("composition");
  Download(composed, levels, &result.maps);
  timer.Finish("download");
  result.reason_to_keep = ReasonToKeep(result.maps, options);
  return result;
}

RefineResult ObserveImage(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    uint32_t image_id,
    const RefineOptions& options,
    Device& device) {
  RefineResult result;
  StageTimer timer(device, &result.seconds);
  DeviceViews views(reference, std::move(sources), device, options.denoise);
  timer.Finish("upload");
  const SingleViewResult single_view =
      RunSingleViewStages(reference, image_id, options, &views, device, &timer);
  const DeviceImage<float> gray = ComputeGray(views.RasterColor(), device);
  result.measured = std::make_unique<MeasuredImage>(MeasuredImage{
      DownloadInputs(views, single_view, gray.View(), device),
      views.DownloadRasterColor(),
      gray.ToHost(),
      RoundedGray(MakeRasterColor(
                      views.Color(), views.Raster(), /*denoise=*/false, device)
                      .ToHost()),
      PackFlags(
          single_view.trusted.View(), single_view.confirmations.View(), device)
          .ToHost(),
      views.camera,
      reference.prior});
  timer.Finish("download");
  return result;
}

void MakeEvidence(const RefineOptions& options,
                  Device& device,
                  RefineResult* result) {
  StageTimer timer(device, &result->seconds);
  MeasuredImage& measured = *result->measured;
  if (options.foreground_fattening) {
    EvidenceInputs& inputs = measured.inputs;
    inputs.fattening_weight =
        ComputeFatteningWeight(measured.gray,
                               inputs.contrast,
                               inputs.superpixels,
                               inputs.num_superpixels,
                               PatchRadius(measured.gray, measured.camera));
  }
  if (measured.prior != nullptr) {
    const Image<RayDepth> samples =
        SamplesToAlignBy(measured.inputs.samples,
                         measured.inputs.texture,
                         measured.inputs.fattening_weight);
    measured.inputs.prior = AlignPrior(*measured.prior, samples);
    AlignNormals(measured.prior->normals,
                 measured.inputs.superpixels,
                 measured.inputs.superpixel_planes,
                 samples,
                 &measured.inputs.prior);
    measured.inputs.tolerance = static_cast<float>(
        ScenePlaneTolerance(options, MeasureNoise(measured.inputs)));
    timer.Finish("prior");
  }
  GatheredEvidence gathered = GatherEvidence(measured.inputs);
  gathered.evidence.color = std::move(measured.color);
  gathered.evidence.gray = std::move(measured.noisy_gray);
  gathered.evidence.flags = std::move(measured.flags);
  timer.Finish("evidence");
  ReduceCandidates(measured.camera, options, device, &gathered);
  result->evidence =
      std::make_unique<ViewEvidence>(std::move(gathered.evidence));
  result->measured.reset();
  timer.Finish("scene planes");
}

}  // namespace tsar
