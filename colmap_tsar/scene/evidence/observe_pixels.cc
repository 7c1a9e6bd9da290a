// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/observe_pixels.h"

#include "colmap_tsar/priors/prior_likelihood.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tsar {
namespace {

bool HasTexture(const EvidenceInputs& inputs,
                int x,
                int y,
                const EvidenceOptions& options) {
  return inputs.texture(x, y) > options.min_texture;
}

float ConfidenceAgainstFattening(const Image<float>& fattening_weight,
                                 int x,
                                 int y,
                                 const EvidenceOptions& options) {
  if (fattening_weight.Empty()) {
    return 1.f;
  }
  const float share = fattening_weight(x, y);
  return std::max(share * share, options.min_own_confidence);
}

float ConfidenceOfMeasurement(const EvidenceInputs& inputs,
                              int x,
                              int y,
                              const EvidenceOptions& options) {
  const float by_texture = HasTexture(inputs, x, y, options)
                               ? 1.f
                               : options.confidence_without_texture;
  return by_texture *
         ConfidenceAgainstFattening(inputs.fattening_weight, x, y, options);
}

// The support by a superpixel's measurements for the planes of its regions.
struct RegionPlaneSupport {
  float on = 0.f;   // Total confidence of inliers of these planes,
  float off = 0.f;  // and of outliers.
};

std::vector<RegionPlaneSupport> MeasureRegionPlaneSupport(
    const EvidenceInputs& inputs,
    const RegionCandidates& regions,
    const EvidenceOptions& options) {
  std::vector<RegionPlaneSupport> supports(
      static_cast<size_t>(inputs.num_superpixels));
  for (int y = 0; y < inputs.superpixels.Height(); ++y) {
    for (int x = 0; x < inputs.superpixels.Width(); ++x) {
      const int region = regions.of_pixels(x, y);
      if (region == 0) {
        continue;
      }
      RegionPlaneSupport& support =
          supports[static_cast<size_t>(inputs.superpixels(x, y))];
      const RayDepth& sample = inputs.samples(x, y);
      if (IsMeasured(sample)) {
        const Plane& plane = regions.planes[static_cast<size_t>(region - 1)];
        const bool is_on = Residual(sample, plane, inputs.resolution) <
                           options.max_region_plane_residual;
        (is_on ? support.on : support.off) +=
            ConfidenceOfMeasurement(inputs, x, y, options);
      }
    }
  }
  return supports;
}

// The confidence of a pixel that takes its depth from the plane of its region:
// 0 where no measurement of its superpixel lies on it.
float ConfidenceOfFill(const RegionPlaneSupport& support,
                       const EvidenceOptions& options) {
  return support.on > 0.f ? options.confidence_of_region_plane * support.on /
                                (support.on + support.off)
                          : 0.f;
}

PriorDepth PriorAt(const AlignedPrior& prior, int x, int y) {
  return prior.Empty()
             ? PriorDepth{}
             : PriorDepth{
                   prior.depth(x, y), prior.sigma(x, y), prior.outlier_share};
}

// The observation of the prior; its confidence is 0 where there is no prior.
PixelObservation ObservePrior(const EvidenceInputs& inputs,
                              int x,
                              int y,
                              const EvidenceOptions& options) {
  const PriorDepth prior = PriorAt(inputs.prior, x, y);
  if (!(prior.depth > 0.f)) {
    return {};
  }
  const Vec3f ray = inputs.intrinsics.Ray(x, y);
  const float expected =
      options.tolerance * inputs.resolution.RelativeDepthError(prior.depth);
  return {{{ray.x, ray.y, prior.depth},
           options.confidence_of_prior * (1.f - prior.outlier_share)},
          ObservationSource::kPrior,
          std::max(options.prior_tolerance * prior.sigma / expected, 1.f)};
}

}  // namespace

bool IsMeasured(const RayDepth& sample) {
  return sample.z > 0.f && std::isfinite(sample.z);
}

float Residual(const RayDepth& sample,
               const Plane& plane,
               const DepthResolution& resolution) {
  const float depth = plane.Depth({sample.x, sample.y, 1.f});
  return std::abs(depth - sample.z) /
         (sample.z * resolution.RelativeDepthError(sample.z));
}

Image<PixelObservation> ObservePixels(const EvidenceInputs& inputs,
                                      const RegionCandidates& regions,
                                      const EvidenceOptions& options,
                                      Image<float>* confident_depth) {
  const int width = inputs.superpixels.Width();
  const int height = inputs.superpixels.Height();
  Image<PixelObservation> observations(width, height);
  *confident_depth = Image<float>(width, height);
  const std::vector<RegionPlaneSupport> supports =
      MeasureRegionPlaneSupport(inputs, regions, options);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const RayDepth& sample = inputs.samples(x, y);
      const int region = regions.of_pixels(x, y);
      if (IsMeasured(sample)) {
        observations(x, y) = {
            {sample, ConfidenceOfMeasurement(inputs, x, y, options)},
            ObservationSource::kMeasured};
        (*confident_depth)(x, y) =
            HasTexture(inputs, x, y, options) ? sample.z : 0.f;
        continue;
      }
      if (region > 0) {
        const Vec3f ray = inputs.intrinsics.Ray(x, y);
        const float depth =
            regions.planes[static_cast<size_t>(region - 1)].Depth(ray);
        if (depth > 0.f && std::isfinite(depth)) {
          const RegionPlaneSupport& support =
              supports[static_cast<size_t>(inputs.superpixels(x, y))];
          // The plane of the region takes precedence unless a prior contradicts
          // it.
          if (LogLikelihoodRatio(PriorAt(inputs.prior, x, y), depth) >= 0.f) {
            observations(x, y) = {
                {{ray.x, ray.y, depth}, ConfidenceOfFill(support, options)},
                ObservationSource::kRegionPlane};
          }
        }
      }
      if (!(observations(x, y).observation.confidence > 0.f)) {
        observations(x, y) = ObservePrior(inputs, x, y, options);
      }
    }
  }
  return observations;
}

}  // namespace tsar
