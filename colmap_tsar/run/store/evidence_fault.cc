// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/evidence_fault.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// Avoids branches: infinity or NaN minus itself is NaN.
bool IsFinite(float value) { return value - value == 0.f; }
bool IsFiniteNotNegative(float value) {
  return IsFinite(value) & (value >= 0.f);
}
bool IsFinitePositive(float value) { return IsFinite(value) & (value > 0.f); }

// Checks all elements, so that the loops over rasters need no branches.
template <typename Container, typename Function>
bool AllOf(const Container& elements, Function is_good) {
  bool all_good = true;
  for (const auto& element : elements) {
    all_good &= is_good(element);
  }
  return all_good;
}

bool BordersFit(const ViewEvidence& evidence) {
  const auto num_pixels =
      static_cast<int64_t>(evidence.superpixels.NumPixels());
  return std::ranges::is_sorted(evidence.borders,
                                {},
                                [](const SuperpixelBorder& border) {
                                  return std::pair(border.first, border.second);
                                }) &&
         AllOf(evidence.borders, [&](const SuperpixelBorder& border) {
           return border.first >= 0 && border.first < border.second &&
                  border.second < evidence.NumSuperpixels() &&
                  AllOf(border.pixels, [&](int pixel) {
                    return pixel >= 0 && pixel < num_pixels;
                  });
         });
}

}  // namespace

std::optional<std::string> FindEvidenceFault(const ViewEvidence& evidence,
                                             EvidenceParts parts) {
  const auto has_raster = [&](const auto& image) {
    return image.Width() == evidence.width && image.Height() == evidence.height;
  };
  const std::vector<int>& first = evidence.first_observation;
  if (evidence.width < 1 || evidence.height < 1 ||
      !has_raster(evidence.superpixels) ||
      !has_raster(evidence.confident_depth) || !has_raster(evidence.color) ||
      first.size() != evidence.weights.size() + 1) {
    return "sizes that do not fit each other";
  }
  const Intrinsics& intrinsics = evidence.intrinsics;
  if (!IsFinitePositive(intrinsics.fx) || !IsFinitePositive(intrinsics.fy) ||
      !IsFinite(intrinsics.cx) || !IsFinite(intrinsics.cy)) {
    return "intrinsics that no camera has";
  }
  if (!IsFiniteNotNegative(evidence.resolution.error_per_depth) ||
      !IsFiniteNotNegative(evidence.noise)) {
    return "a noise that is no number";
  }
  const size_t num_superpixels = evidence.weights.size();
  if (!AllOf(evidence.superpixels,
             [&](uint16_t label) { return label < num_superpixels; })) {
    return "a label that no superpixel has";
  }
  if (!AllOf(evidence.weights, IsFiniteNotNegative)) {
    return "a superpixel's invalid weight";
  }
  if (first.front() != 0 || !std::ranges::is_sorted(first) ||
      static_cast<size_t>(first.back()) != evidence.observations.size() ||
      evidence.sources.size() != evidence.observations.size() ||
      !(evidence.errors.empty() ||
        evidence.errors.size() == evidence.observations.size())) {
    return "observations that are not those of the superpixels";
  }
  if (!AllOf(evidence.observations,
             [](const Observation& observation) {
               const RayDepth& sample = observation.sample;
               return IsFinite(sample.x) & IsFinite(sample.y) &
                      IsFinitePositive(sample.z) &
                      IsFinitePositive(observation.confidence);
             }) ||
      !AllOf(evidence.errors, IsFinitePositive)) {
    return "an invalid observation";
  }
  if (!AllOf(evidence.sources, [](ObservationSource source) {
        return source <= ObservationSource::kPrior;
      })) {
    return "an observation of an unknown kind";
  }
  if (!AllOf(evidence.candidates, [](const Plane& plane) {
        return IsFinite(plane.normal.x) & IsFinite(plane.normal.y) &
               IsFinite(plane.normal.z) & IsFinitePositive(plane.offset);
      })) {
    return "an invalid plane";
  }
  if (!AllOf(evidence.confident_depth, IsFiniteNotNegative)) {
    return "an invalid depth";
  }
  if (parts == EvidenceParts::kForNeighbors) {
    return std::nullopt;
  }
  const std::vector<int>& first_confirmed = evidence.first_confirmed;
  if (evidence.flags.Empty() || first_confirmed.size() != first.size() ||
      evidence.confirmed_pixels.size() != num_superpixels) {
    return "sizes that do not fit each other";
  }
  const AlignedPrior& prior = evidence.prior;
  if (prior.Empty() != (prior.assessment.verdict != PriorVerdict::kUsed) ||
      !IsFiniteNotNegative(prior.assessment.skill)) {
    return "an invalid prior";
  }
  if (!prior.Empty() &&
      (!has_raster(prior.depth) || !has_raster(prior.sigma) ||
       !AllOf(prior.depth, IsFiniteNotNegative) ||
       !AllOf(prior.sigma, IsFiniteNotNegative) ||
       !(prior.outlier_share > 0.f && prior.outlier_share < 1.f))) {
    return "an invalid prior";
  }
  const bool uses_normals = prior.assessment.of_normals == PriorVerdict::kUsed;
  if (prior.normals.size() != (uses_normals ? num_superpixels : 0) ||
      !IsFiniteNotNegative(prior.assessment.normal_sigma) ||
      (uses_normals && !(prior.assessment.normal_sigma > 0.f &&
                         prior.normal_outlier_share > 0.f &&
                         prior.normal_outlier_share < 1.f)) ||
      !AllOf(prior.normals, [](const Vec3f& normal) {
        return IsFinite(normal.x) & IsFinite(normal.y) & IsFinite(normal.z);
      })) {
    return "an invalid prior";
  }
  if (first_confirmed.front() != 0 ||
      !std::ranges::is_sorted(first_confirmed) ||
      static_cast<size_t>(first_confirmed.back()) !=
          evidence.confirmed.size() ||
      !AllOf(evidence.confirmed_pixels, [](int count) { return count >= 0; })) {
    return "confirmed depths that are not those of the superpixels";
  }
  if (!AllOf(evidence.confirmed, [](const RayDepth& sample) {
        return IsFinite(sample.x) & IsFinite(sample.y) &
               IsFinitePositive(sample.z);
      })) {
    return "an invalid confirmed depth";
  }
  if (!BordersFit(evidence)) {
    return "borders that are not those of the superpixels";
  }
  if (!AllOf(evidence.borders, [](const SuperpixelBorder& border) {
        return IsFiniteNotNegative(border.weight);
      })) {
    return "a border's invalid weight";
  }
  return std::nullopt;
}

}  // namespace tsar
