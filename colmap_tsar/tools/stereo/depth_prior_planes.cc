// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/depth_prior_planes.h"

#include "colmap_tsar/matching/gray_pair.h"
#include "colmap_tsar/priors/prior_likelihood.h"
#include "colmap_tsar/priors/prior_raster.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"
#include "colmap_tsar/scene/evidence/texture_measures.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/superpixels/samples.h"

#include <utility>

namespace tsar {
namespace {

// The reliable depths on texture, on the raster of a refinement.
Image<RayDepth> SampleTexturedDepths(const ViewData& reference,
                                     const DeviceImage<float>& reliable_depth,
                                     Device& device) {
  const ReducedRaster raster =
      MakeRaster(reliable_depth.Width(), reliable_depth.Height());
  const DeviceImage<Rgb> color(device, reference.color);
  const DeviceImage<Rgb> reduced =
      MakeRasterColor(color.View(), raster, /*denoise=*/true, device);
  const DeviceImage<float> gray = ComputeGray(reduced.View(), device);
  const Image<float> depth =
      ReduceNearest(reliable_depth.View(), raster, device).ToHost();
  const Intrinsics intrinsics =
      reference.camera.Resized(raster.width, raster.height).GetIntrinsics();
  Image<RayDepth> samples(raster.width, raster.height);
  for (int y = 0; y < raster.height; ++y) {
    for (int x = 0; x < raster.width; ++x) {
      const Vec3f ray = intrinsics.Ray(x, y);
      samples(x, y) = {ray.x, ray.y, depth(x, y)};
    }
  }
  return SamplesToAlignBy(std::move(samples),
                          ComputeTexture(gray.View(), device).ToHost(),
                          /*fattening_weight=*/{});
}

}  // namespace

PriorAssessment UseDepthPrior(const ViewData& reference,
                              const DeviceImage<float>& reliable_depth,
                              Device& device,
                              Image<Plane>* planes) {
  const AlignedPrior aligned =
      AlignPrior(*reference.prior,
                 SampleTexturedDepths(reference, reliable_depth, device));
  if (aligned.Empty()) {
    return aligned.assessment;
  }
  const auto min_probability =
      static_cast<float>(RefineOptions().min_fill_confidence);
  const Intrinsics intrinsics = reference.camera.GetIntrinsics();
  const PriorRaster prior{aligned.depth.View(),
                          aligned.sigma.View(),
                          aligned.outlier_share,
                          intrinsics,
                          planes->Width(),
                          planes->Height()};
  for (int y = 0; y < planes->Height(); ++y) {
    for (int x = 0; x < planes->Width(); ++x) {
      const PriorDepth at = prior.At(x, y);
      if (!(at.depth > 0.f) || ProbabilityOfSurface(at) < min_probability) {
        continue;
      }
      // A plane that the prior does not contradict is the more exact one, since
      // its corners were measured.
      Plane& plane = (*planes)(x, y);
      const Vec3f ray = intrinsics.Ray(x, y);
      if (plane.Valid() && LogLikelihoodRatio(at, plane.Depth(ray)) >= 0.f) {
        continue;
      }
      plane = Plane::FromPoint(ray, at.depth, prior.NormalAt(x, y));
    }
  }
  return aligned.assessment;
}

}  // namespace tsar
