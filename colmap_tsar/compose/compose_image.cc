// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/compose_image.h"

#include "colmap_tsar/compose/apply_cylinders.h"
#include "colmap_tsar/compose/compose_map.h"
#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/compose/depth_sigma.h"
#include "colmap_tsar/compose/occlusion_votes.h"
#include "colmap_tsar/compose/upsample_depth_flags.h"
#include "colmap_tsar/matching/gray_texture.h"
#include "colmap_tsar/scene/evidence/texture_measures.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/scene/scene_options.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/stage_timer.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace tsar {
namespace {

DeviceImage<float> RasterTexture(const ViewEvidence& evidence, Device& device) {
  const DeviceImage<float> gray =
      ComputeGray(DeviceImage<Rgb>(device, evidence.color).View(), device);
  return ComputeTexture(gray.View(), device);
}

// The labels of superpixels with their evidence and the errors of their planes.
std::vector<ComposedSuperpixel> DescribeSuperpixels(
    const FoundScene& found, const std::vector<Vec3f>& prior_normals) {
  std::vector<ComposedSuperpixel> result;
  for (size_t k = 0; k < found.labels.origins.size(); ++k) {
    const int label = found.labels.planes[k];
    const LabelQuality& quality = found.labels.qualities[k];
    result.push_back(
        {found.labels.origins[k],
         {quality.strength.Value(),
          quality.confirmed.Value(),
          quality.uncertainty.Value(),
          quality.margin.Value()},
         label >= 0 ? found.plane_errors[label] : InverseDepthError{},
         prior_normals.empty() ? Vec3f{} : prior_normals[k]});
  }
  return result;
}

// The residual up to which a confirmed depth is moved onto its plane, in
// standard deviations of depths at their planes, and its lower limit as a share
// of a pixel of disparity, below the resolution of matching.
constexpr double kDeviationsOnPlane = 3.0;
constexpr double kMinDeviationOnPlane = 0.3;

}  // namespace

ComposeSceneOptions MakeCompositionOptions(
    const std::vector<ObservedView>& views) {
  ComposeSceneOptions options;
  options.on_plane =
      static_cast<float>(std::clamp(kDeviationsOnPlane * MedianNoise(views),
                                    kMinDeviationOnPlane,
                                    double{options.on_plane}));
  return options;
}

RefineResult ComposeImage(const ViewData& reference,
                          const std::vector<ObservedView>& views,
                          const FoundScene& found,
                          const RefineOptions& options,
                          Device& device) {
  RefineResult result;
  result.seconds = found.seconds;
  StageTimer timer(device, &result.seconds);
  const ViewEvidence& evidence = *views[0].evidence;
  result.prior = evidence.prior.assessment;
  DeviceReference view(reference, device);
  const DeviceImage<uint8_t> flags = UpsampleDepthFlags(evidence, view, device);
  const DeviceImage<uint16_t> superpixels(device, evidence.superpixels);
  const DeviceImage<Plane> scene_planes =
      PlanesOfLabels(superpixels.View(),
                     Buffer<Plane>(device, PlanesOfSuperpixels(found)),
                     device);
  const Buffer<ComposedSuperpixel> of_superpixel(
      device, DescribeSuperpixels(found, evidence.prior.normals));
  const DeviceImage<float> texture = RasterTexture(evidence, device);
  const DeviceImage<float> prior_depth(device, evidence.prior.depth);
  const DeviceImage<float> prior_sigma(device, evidence.prior.sigma);
  timer.Finish("upload");
  const ComposeSceneInputs inputs{flags.View(),
                                  view.OnMap(scene_planes),
                                  superpixels.View(),
                                  of_superpixel.Data(),
                                  texture.View(),
                                  {prior_depth.View(),
                                   prior_sigma.View(),
                                   evidence.prior.outlier_share,
                                   view.MapIntrinsics(),
                                   view.hypotheses.depth.Width(),
                                   view.hypotheses.depth.Height()}};
  const ViewSurfaces surfaces{views, found.planes_of_sources};
  ComposedMap composed = ComposeScene(std::move(view.hypotheses),
                                      inputs,
                                      surfaces,
                                      evidence.resolution,
                                      MakeCompositionOptions(views),
                                      device);
  const DeviceImage<float> variances_on_cylinders =
      ApplyCylinders(found.cylinders,
                     flags.View(),
                     view.MapIntrinsics(),
                     evidence.resolution,
                     &composed,
                     device);
  // Wider holes have no plane because the images contradict the planes around.
  constexpr int kHoleIterations = 1;
  FillHoles(view.color.View(),
            view.MapIntrinsics(),
            options,
            kHoleIterations,
            &composed,
            device);
  const auto min_fill_confidence =
      static_cast<float>(options.min_fill_confidence);
  DeviceImage<float> confidence =
      ComputeSceneConfidence(composed,
                             inputs,
                             surfaces,
                             evidence.resolution,
                             variances_on_cylinders.View(),
                             evidence.noise,
                             min_fill_confidence,
                             device);
  FillByPrior(inputs, min_fill_confidence, &composed, &confidence, device);
  const DeviceImage<uint8_t> levels =
      FinishMap(static_cast<float>(options.min_confidence),
                view.MapIntrinsics(),
                confidence.View(),
                &composed,
                device);
  if (options.sigma_maps) {
    result.maps.sigma = ComputeSceneSigma(composed,
                                          inputs,
                                          evidence.resolution,
                                          variances_on_cylinders.View(),
                                          evidence.noise,
                                          {},
                                          device)
                            .ToHost();
  }
  timer.Finish("composition");
  const DeviceImage<uint16_t> plane_ids(device,
                                        PlaneIds(evidence.superpixels, found));
  result.maps.planes = MapPlanes(std::as_const(composed.map.depth).View(),
                                 view.OnMap(scene_planes),
                                 plane_ids.View(),
                                 device)
                           .ToHost();
  Download(composed, levels, &result.maps);
  timer.Finish("download");
  result.reason_to_keep = ReasonToKeep(result.maps, options);
  return result;
}

}  // namespace tsar
