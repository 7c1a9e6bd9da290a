// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/evidence_check.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// Without branches: infinity or NaN minus itself is NaN.
bool IsFinite(float value) { return value - value == 0.f; }
bool IsFiniteNotNegative(float value) {
  return IsFinite(value) & (value >= 0.f);
}
bool IsFinitePositive(float value) { return IsFinite(value) & (value > 0.f); }

// Looks at all elements, so that the loops over rasters need no branches.
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
      !has_raster(evidence.confident_depth) ||
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
      static_cast<size_t>(first.back()) != evidence.observations.size()) {
    return "observations that are not those of the superpixels";
  }
  if (!AllOf(evidence.observations, [](const Observation& observation) {
        const RayDepth& sample = observation.sample;
        return IsFinite(sample.x) & IsFinite(sample.y) &
               IsFinitePositive(sample.z) & (observation.confidence > 0.f) &
               (observation.confidence <= 1.f);
      })) {
    return "an invalid observation";
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
  if (parts == EvidenceParts::kForNeighbours) {
    return std::nullopt;
  }
  if (!has_raster(evidence.region_planes) || !has_raster(evidence.color) ||
      evidence.ratings.Empty()) {
    return "sizes that do not fit each other";
  }
  const std::vector<int>& first_confirmed = evidence.first_confirmed;
  if (evidence.is_measured.size() != evidence.observations.size() ||
      first_confirmed.size() != first.size() ||
      evidence.confirmed_pixels.size() != num_superpixels) {
    return "sizes that do not fit each other";
  }
  if (!AllOf(evidence.is_measured, [](uint8_t flag) { return flag <= 1; })) {
    return "an observation of an unknown kind";
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
  const size_t num_candidates = evidence.candidates.size();
  if (!AllOf(evidence.region_planes,
             [&](uint16_t number) { return number <= num_candidates; })) {
    return "a region's plane that is not among the candidates";
  }
  return std::nullopt;
}

}  // namespace tsar
