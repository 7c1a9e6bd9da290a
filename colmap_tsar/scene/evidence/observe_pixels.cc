// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/observe_pixels.h"

#include "colmap_tsar/priors/prior_likelihood.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <unordered_map>

namespace tsar {
namespace {

// Planes of regions with fewer pixels are no candidates: these are fragments
// beyond the reach of another plane.
constexpr int kMinCandidatePixels = 30;
// The confidence of measurements on texture weaker than kMinTexture.
constexpr float kConfidenceWithoutTexture = 0.5f;
// The confidence of measurements is multiplied by the square of their
// fattening weight, but by no less than this, where the texture is not the
// pixel's own.
constexpr float kMinOwnConfidence = 0.02f;
// The confidence of a pixel that was not measured, but lies in a region that
// has a plane.
constexpr float kConfidenceOfRegionPlane = 0.3f;
// That confidence is lower where measurements in the same superpixel have
// residuals at the plane above this multiple of RelativeDepthError().
constexpr float kMaxRegionPlaneResidual = 6.f;
// The confidence of a pixel whose depth comes from a prior alone: errors of
// priors are correlated over whole surfaces.
constexpr float kConfidenceOfPrior = 0.1f;
// The tolerance of priors, in their standard deviations.
constexpr float kPriorTolerance = 2.f;

bool HasTexture(const EvidenceInputs& inputs, int x, int y) {
  return inputs.texture(x, y) > kMinTexture;
}

float ConfidenceOfMeasurement(const EvidenceInputs& inputs, int x, int y) {
  const float by_texture =
      HasTexture(inputs, x, y) ? 1.f : kConfidenceWithoutTexture;
  if (inputs.fattening_weight.Empty()) {
    return by_texture;
  }
  const float share = inputs.fattening_weight(x, y);
  return by_texture * std::max(share * share, kMinOwnConfidence);
}

// The support by a superpixel's measurements for the planes of its regions.
struct RegionPlaneSupport {
  float on = 0.f;   // Total confidence of inliers of these planes,
  float off = 0.f;  // and of outliers.
};

std::vector<RegionPlaneSupport> MeasureRegionPlaneSupport(
    const EvidenceInputs& inputs, const RegionCandidates& regions) {
  std::vector<RegionPlaneSupport> supports(inputs.num_superpixels);
  for (int y = 0; y < inputs.superpixels.Height(); ++y) {
    for (int x = 0; x < inputs.superpixels.Width(); ++x) {
      const int region = regions.of_pixels(x, y);
      const RayDepth& sample = inputs.samples(x, y);
      if (region == 0 || !IsMeasured(sample)) {
        continue;
      }
      const Plane& plane = regions.planes[region - 1];
      const bool is_on =
          Residual(sample, plane, inputs.resolution) < kMaxRegionPlaneResidual;
      RegionPlaneSupport& support = supports[inputs.superpixels(x, y)];
      (is_on ? support.on : support.off) +=
          ConfidenceOfMeasurement(inputs, x, y);
    }
  }
  return supports;
}

// The confidence of a pixel that takes its depth from the plane of its region:
// 0 where no measurement of its superpixel lies on it.
float ConfidenceOfFill(const RegionPlaneSupport& support) {
  return support.on > 0.f ? kConfidenceOfRegionPlane * support.on /
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
PixelObservation ObservePrior(const EvidenceInputs& inputs, int x, int y) {
  const PriorDepth prior = PriorAt(inputs.prior, x, y);
  if (!(prior.depth > 0.f)) {
    return {};
  }
  const Vec3f ray = inputs.intrinsics.Ray(x, y);
  const float expected =
      inputs.tolerance * inputs.resolution.RelativeDepthError(prior.depth);
  return {{{ray.x, ray.y, prior.depth},
           kConfidenceOfPrior * (1.f - prior.outlier_share)},
          ObservationSource::kPrior,
          std::max(kPriorTolerance * prior.sigma / expected, 1.f)};
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

RegionCandidates FindRegionCandidates(const EvidenceInputs& inputs) {
  // Planes are equal where their bits are.
  using Bits = std::array<uint64_t, 2>;
  const auto hash = [](const Bits& bits) {
    return bits[0] * 1000003u ^ bits[1];
  };
  struct RegionPlane {
    int num_pixels = 0;
    uint16_t candidate = 0;
  };
  std::unordered_map<Bits, RegionPlane, decltype(hash)> regions;
  for (const Plane& plane : inputs.region_planes) {
    ++regions[std::bit_cast<Bits>(plane)].num_pixels;
  }
  RegionCandidates result;
  result.of_pixels =
      Image<uint16_t>(inputs.superpixels.Width(), inputs.superpixels.Height());
  for (size_t i = 0; i < inputs.region_planes.NumPixels(); ++i) {
    const Plane& plane = inputs.region_planes.Data()[i];
    RegionPlane& region = regions[std::bit_cast<Bits>(plane)];
    if (plane.Valid() && region.candidate == 0 &&
        region.num_pixels >= kMinCandidatePixels &&
        result.planes.size() < UINT16_MAX) {
      result.planes.push_back(plane);
      region.candidate = static_cast<uint16_t>(result.planes.size());
    }
    result.of_pixels.Data()[i] = region.candidate;
  }
  return result;
}

Image<PixelObservation> ObservePixels(const EvidenceInputs& inputs,
                                      const RegionCandidates& regions,
                                      Image<float>* confident_depth) {
  const int width = inputs.superpixels.Width();
  const int height = inputs.superpixels.Height();
  Image<PixelObservation> observations(width, height);
  *confident_depth = Image<float>(width, height);
  const std::vector<RegionPlaneSupport> supports =
      MeasureRegionPlaneSupport(inputs, regions);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const RayDepth& sample = inputs.samples(x, y);
      const int region = regions.of_pixels(x, y);
      if (IsMeasured(sample)) {
        observations(x, y) = {{sample, ConfidenceOfMeasurement(inputs, x, y)},
                              ObservationSource::kMeasured};
        (*confident_depth)(x, y) = HasTexture(inputs, x, y) ? sample.z : 0.f;
        continue;
      }
      if (region > 0) {
        const Vec3f ray = inputs.intrinsics.Ray(x, y);
        const float depth = regions.planes[region - 1].Depth(ray);
        // The plane of the region takes precedence unless a prior contradicts
        // it.
        if (depth > 0.f && std::isfinite(depth) &&
            LogLikelihoodRatio(PriorAt(inputs.prior, x, y), depth) >= 0.f) {
          observations(x, y) = {
              {{ray.x, ray.y, depth},
               ConfidenceOfFill(supports[inputs.superpixels(x, y)])},
              ObservationSource::kRegionPlane};
        }
      }
      if (!(observations(x, y).observation.confidence > 0.f)) {
        observations(x, y) = ObservePrior(inputs, x, y);
      }
    }
  }
  return observations;
}

}  // namespace tsar
