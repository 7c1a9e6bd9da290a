// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/evidence_fault.h"

#include "colmap_tsar/base/arithmetic.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// The checks below use no branches, so that loops over rasters are vectorized.
bool IsFiniteNotNegative(float value) {
  return IsFinite(value) & (value >= 0.f);
}
bool IsFinitePositive(float value) { return IsFinite(value) & (value > 0.f); }
bool IsFiniteVector(const Vec3f& vector) {
  return IsFinite(vector.x) & IsFinite(vector.y) & IsFinite(vector.z);
}
bool IsInFront(const RayDepth& sample) {
  return IsFinite(sample.x) & IsFinite(sample.y) & IsFinitePositive(sample.z);
}

template <typename Container, typename Function>
bool AllOf(const Container& elements, Function is_good) {
  bool all_good = true;
  for (const auto& element : elements) {
    all_good &= is_good(element);
  }
  return all_good;
}

bool HasRaster(const ViewEvidence& evidence, const auto& image) {
  return image.Width() == evidence.width && image.Height() == evidence.height;
}

// The fault of the parts for neighbors.
std::optional<std::string> FindNeighborFault(const ViewEvidence& evidence) {
  const std::vector<int>& first = evidence.first_observation;
  const size_t num_superpixels = evidence.weights.size();
  const size_t num_observations = evidence.observations.size();
  const Intrinsics& intrinsics = evidence.intrinsics;
  if (evidence.width < 1 || evidence.height < 1 ||
      !HasRaster(evidence, evidence.superpixels) ||
      !HasRaster(evidence, evidence.confident_depth) ||
      !HasRaster(evidence, evidence.color) ||
      first.size() != num_superpixels + 1) {
    return "sizes that do not fit each other";
  }
  if (!IsFinitePositive(intrinsics.fx) || !IsFinitePositive(intrinsics.fy) ||
      !IsFinite(intrinsics.cx) || !IsFinite(intrinsics.cy)) {
    return "intrinsics that no camera has";
  }
  if (!IsFiniteNotNegative(evidence.resolution.error_per_depth) ||
      !IsFiniteNotNegative(evidence.noise)) {
    return "a noise that is no number";
  }
  if (!AllOf(evidence.superpixels,
             [&](uint16_t label) { return label < num_superpixels; })) {
    return "a label that no superpixel has";
  }
  if (!AllOf(evidence.weights, IsFiniteNotNegative)) {
    return "a superpixel's invalid weight";
  }
  if (first.front() != 0 || !std::ranges::is_sorted(first) ||
      static_cast<size_t>(first.back()) != num_observations ||
      evidence.sources.size() != num_observations ||
      !(evidence.errors.empty() ||
        evidence.errors.size() == num_observations)) {
    return "observations that are not those of the superpixels";
  }
  if (!AllOf(evidence.observations,
             [](const Observation& observation) {
               return IsInFront(observation.sample) &
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
        return IsFiniteVector(plane.normal) & IsFinitePositive(plane.offset);
      })) {
    return "an invalid plane";
  }
  if (!AllOf(evidence.confident_depth, IsFiniteNotNegative)) {
    return "an invalid depth";
  }
  return std::nullopt;
}

bool IsShare(float value) { return value > 0.f && value < 1.f; }

bool IsValidPrior(const ViewEvidence& evidence) {
  const AlignedPrior& prior = evidence.prior;
  const PriorAssessment& assessment = prior.assessment;
  const bool uses_depth = assessment.verdict == PriorVerdict::kUsed;
  const bool uses_normals = assessment.of_normals == PriorVerdict::kUsed;
  return prior.Empty() != uses_depth && IsFiniteNotNegative(assessment.skill) &&
         (!uses_depth || (HasRaster(evidence, prior.depth) &&
                          HasRaster(evidence, prior.sigma) &&
                          AllOf(prior.depth, IsFiniteNotNegative) &&
                          AllOf(prior.sigma, IsFiniteNotNegative) &&
                          IsShare(prior.outlier_share))) &&
         prior.normals.size() == (uses_normals ? evidence.weights.size() : 0) &&
         IsFiniteNotNegative(assessment.normal_sigma) &&
         (!uses_normals || (assessment.normal_sigma > 0.f &&
                            IsShare(prior.normal_outlier_share))) &&
         AllOf(prior.normals, IsFiniteVector);
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

// The fault of the parts that only the view itself needs.
std::optional<std::string> FindOwnFault(const ViewEvidence& evidence) {
  const std::vector<int>& first = evidence.first_confirmed;
  if (evidence.flags.Empty() ||
      first.size() != evidence.first_observation.size() ||
      evidence.confirmed_pixels.size() != evidence.weights.size()) {
    return "sizes that do not fit each other";
  }
  if (!IsValidPrior(evidence)) {
    return "an invalid prior";
  }
  if (first.front() != 0 || !std::ranges::is_sorted(first) ||
      static_cast<size_t>(first.back()) != evidence.confirmed.size() ||
      !AllOf(evidence.confirmed_pixels, [](int count) { return count >= 0; })) {
    return "confirmed depths that are not those of the superpixels";
  }
  if (!AllOf(evidence.confirmed, IsInFront)) {
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

}  // namespace

std::optional<std::string> FindEvidenceFault(const ViewEvidence& evidence,
                                             EvidenceParts parts) {
  std::optional<std::string> fault = FindNeighborFault(evidence);
  return fault || parts == EvidenceParts::kForNeighbors
             ? fault
             : FindOwnFault(evidence);
}

}  // namespace tsar
