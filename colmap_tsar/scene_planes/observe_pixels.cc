// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/observe_pixels.h"

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

// What the measurements of a superpixel say of the planes of the regions that
// it belongs to.
struct RegionPlaneSupport {
  float on = 0.f;   // The confidences of measurements on these planes,
  float off = 0.f;  // and of those off them.
};

std::vector<RegionPlaneSupport> MeasureRegionPlaneSupport(
    const EvidenceInputs& inputs,
    const EvidenceOptions& options,
    const ViewEvidence& evidence) {
  std::vector<RegionPlaneSupport> supports(
      static_cast<size_t>(inputs.num_superpixels));
  for (int y = 0; y < evidence.height; ++y) {
    for (int x = 0; x < evidence.width; ++x) {
      const int number = evidence.region_planes(x, y);
      if (number == 0) {
        continue;
      }
      RegionPlaneSupport& support =
          supports[static_cast<size_t>(inputs.superpixels(x, y))];
      const RayDepth& sample = inputs.samples(x, y);
      if (IsMeasured(sample)) {
        const Plane& plane =
            evidence.candidates[static_cast<size_t>(number - 1)];
        const bool is_on = Residual(sample, plane, inputs.resolution) <
                           options.max_region_plane_residual;
        (is_on ? support.on : support.off) +=
            ConfidenceOfMeasurement(inputs, x, y, options);
      }
    }
  }
  return supports;
}

// What a pixel counts that takes its depth from the plane of its region:
// nothing where no measurement of its superpixel lies on it.
float ConfidenceOfFill(const RegionPlaneSupport& support,
                       const EvidenceOptions& options) {
  return support.on > 0.f ? options.confidence_of_region_plane * support.on /
                                (support.on + support.off)
                          : 0.f;
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

Image<Observation> ObservePixels(const EvidenceInputs& inputs,
                                 const EvidenceOptions& options,
                                 ViewEvidence* evidence) {
  Image<Observation> observations(evidence->width, evidence->height);
  evidence->confident_depth = Image<float>(evidence->width, evidence->height);
  const std::vector<RegionPlaneSupport> supports =
      MeasureRegionPlaneSupport(inputs, options, *evidence);
  for (int y = 0; y < evidence->height; ++y) {
    for (int x = 0; x < evidence->width; ++x) {
      const RayDepth& sample = inputs.samples(x, y);
      const int number = evidence->region_planes(x, y);
      if (IsMeasured(sample)) {
        observations(x, y) = {sample,
                              ConfidenceOfMeasurement(inputs, x, y, options)};
        evidence->confident_depth(x, y) =
            HasTexture(inputs, x, y, options) ? sample.z : 0.f;
      } else if (number > 0) {
        const Vec3f ray = inputs.intrinsics.Ray(x, y);
        const float depth =
            evidence->candidates[static_cast<size_t>(number - 1)].Depth(ray);
        if (depth > 0.f && std::isfinite(depth)) {
          const RegionPlaneSupport& support =
              supports[static_cast<size_t>(inputs.superpixels(x, y))];
          observations(x, y) = {{ray.x, ray.y, depth},
                                ConfidenceOfFill(support, options)};
        }
      }
    }
  }
  return observations;
}

}  // namespace tsar
