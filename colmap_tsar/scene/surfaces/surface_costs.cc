// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/surface_costs.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <utility>

namespace tsar {
namespace {

// Calls body(part, values) for parts of a range that fit into an array on the
// stack: ranges are mostly so short that an allocation would cost time.
template <typename Body>
void ForParts(const SampleRange& range, const Body& body) {
  constexpr size_t kLength = 64;
  static_assert(kLength % SampleRange::kAlignment == 0);
  std::array<float, kLength> values;
  for (size_t i = 0; i < range.count; i += kLength) {
    body(SampleRange{range.begin + i, std::min(kLength, range.count - i)},
         values.data());
  }
}

}  // namespace

SurfaceCosts::SurfaceCosts(const std::vector<ObservedView>& views,
                           const LabeledView& labeled,
                           const CurvedSurfaceOptions& options)
    : evidence_(*views[0].evidence),
      intrinsics_(views[0].camera.GetIntrinsics()),
      resolution_(evidence_.resolution),
      labeled_(labeled),
      options_(options) {
  for (size_t j = 1; j < views.size(); ++j) {
    sources_.push_back(MakeObservedSource(views[0], views[j]));
    sources_.back().confident_depth = views[j].evidence->confident_depth.View();
  }
  MakeSuperpixels();
}

void SurfaceCosts::MakeSuperpixels() {
  ListPixels();
  superpixels_.resize(evidence_.NumSuperpixels());
  for (const SuperpixelBorder& border : evidence_.borders) {
    superpixels_[border.first].neighbors.push_back(border.second);
    superpixels_[border.second].neighbors.push_back(border.first);
  }
  num_measured_.assign(labeled_.planes.size(), 0);
  for (int s = 0; s < Count(); ++s) {
    Superpixel& superpixel = superpixels_[s];
    std::ranges::sort(superpixel.neighbors);
    superpixel.num_pixels = first_pixel_[s + 1] - first_pixel_[s];
    AddSamples(s, &superpixel);
    AddTests(s, &superpixel);
    const int label = LabelOf(s);
    superpixel.residual =
        label < 0 ? options_.labels.cost_of_unexplained
                  : Measure(superpixel, PlaneSurface(label)).residual;
    if (label >= 0 && superpixel.IsMeasured()) {
      ++num_measured_[label];
    }
  }
  shares_.resize(superpixels_.size());
}

void SurfaceCosts::ListPixels() {
  first_pixel_.assign(evidence_.NumSuperpixels() + 1, 0);
  for (const uint16_t s : evidence_.superpixels) {
    ++first_pixel_[s + 1];
  }
  std::partial_sum(
      first_pixel_.begin(), first_pixel_.end(), first_pixel_.begin());
  std::vector<int> next = first_pixel_;
  pixels_.resize(evidence_.superpixels.NumPixels());
  int pixel = 0;
  for (const uint16_t s : evidence_.superpixels) {
    pixels_[next[s]++] = pixel++;
  }
}

void SurfaceCosts::AddSamples(int s, Superpixel* superpixel) {
  std::vector<Observation> observations;
  float all = 0.f;
  for (int k = evidence_.first_observation[s];
       k < evidence_.first_observation[s + 1];
       ++k) {
    const Observation& observation = evidence_.observations[k];
    all += observation.confidence;
    if (observation.confidence >= options_.min_confidence &&
        !evidence_.IsOfPrior(k)) {
      observations.push_back(observation);
      superpixel->confidence += observation.confidence;
    }
  }
  superpixel->weight =
      all > 0.f ? evidence_.weights[s] * superpixel->confidence / all : 0.f;
  if (superpixel->weight < options_.min_measured * superpixel->num_pixels) {
    observations.clear();
    superpixel->confidence = 0.f;
    superpixel->weight = 0.f;
  }
  superpixel->samples = samples_.Add(observations, resolution_);
}

void SurfaceCosts::AddTests(int s, Superpixel* superpixel) {
  const int num_pixels = superpixel->num_pixels;
  const int num_tests =
      num_pixels > 0 ? kCurvedSampling.NumTests(num_pixels) : 0;
  const int first = first_pixel_[s];
  std::vector<Vec3f> rays;
  for (int i = 0; i < num_tests; ++i) {
    rays.push_back(
        RayOf(pixels_[first + VoteSampling::Pixel(i, num_tests, num_pixels)]));
  }
  superpixel->tests = tests_.Add(rays);
}

Vec3f SurfaceCosts::MiddleOf(int s) const {
  Vec3f sum;
  for (int k = first_pixel_[s]; k < first_pixel_[s + 1]; ++k) {
    sum = sum + RayOf(pixels_[k]);
  }
  return sum.z > 0.f ? sum * (1.f / sum.z) : sum;
}

CurvedSurface SurfaceCosts::PlaneSurface(int label) const {
  const Plane& plane = labeled_.planes[label];
  CurvedSurface surface;
  surface.coefficients[0] = -plane.normal.z / plane.offset;
  surface.coefficients[1] = -plane.normal.x / plane.offset;
  surface.coefficients[2] = -plane.normal.y / plane.offset;
  return surface;
}

MeasuredFit SurfaceCosts::Measure(const Superpixel& superpixel,
                                  const CurvedSurface& surface) const {
  const float tolerance = options_.labels.tolerance;
  MeasuredFit fit;
  float sum = 0.f;
  ForParts(superpixel.samples, [&](const SampleRange& part, float* values) {
    ComputeDifferences(surface, samples_, part, values);
    for (size_t i = 0; i < part.count; ++i) {
      const float depth = samples_.depth[part.begin + i];
      if (values[i] < tolerance) {
        fit.min_depth = std::min(fit.min_depth, depth);
        fit.max_depth = std::max(fit.max_depth, depth);
      }
      const float share = std::min(values[i] / tolerance, 1.f);
      sum += samples_.confidence[part.begin + i] * share * share;
    }
  });
  if (superpixel.IsMeasured()) {
    fit.residual = sum / superpixel.confidence;
  }
  return fit;
}

float SurfaceCosts::ResidualOfNearest(int s,
                                      const std::vector<int>& planes) const {
  const Superpixel& superpixel = At(s);
  std::vector<float> nearest(superpixel.samples.count, 1.f);
  for (const int plane : planes) {
    const std::vector<float>& shares = FindShares(s, plane);
    for (size_t i = 0; i < nearest.size(); ++i) {
      nearest[i] = std::min(nearest[i], shares[i]);
    }
  }
  float sum = 0.f;
  for (size_t i = 0; i < nearest.size(); ++i) {
    sum += samples_.confidence[superpixel.samples.begin + i] * nearest[i] *
           nearest[i];
  }
  return sum / superpixel.confidence;
}

const std::vector<float>& SurfaceCosts::FindShares(int s, int plane) const {
  const auto [entry, is_new] = shares_[s].try_emplace(plane);
  std::vector<float>& shares = entry->second;
  if (is_new) {
    const SampleRange& samples = At(s).samples;
    shares.resize(samples.PaddedCount());
    ComputeDifferences(PlaneSurface(plane), samples_, samples, shares.data());
    for (float& share : shares) {
      share /= options_.labels.tolerance;
    }
  }
  return shares;
}

float SurfaceCosts::PresentCost(int s) const {
  const Superpixel& superpixel = At(s);
  if (LabelOf(s) >= 0) {
    return Cost(superpixel, superpixel.residual);
  }
  const float num_unmeasured =
      std::max(superpixel.num_pixels - superpixel.weight, 0.f);
  return superpixel.weight * superpixel.residual +
         options_.labels.unlabeled_cost * num_unmeasured;
}

SuperpixelVotes SurfaceCosts::AskSources(const Superpixel& superpixel,
                                         const CurvedSurface& surface) const {
  const float max_gap =
      options_.labels.confirmation_share * options_.labels.tolerance;
  SuperpixelVotes sum;
  sum.num_tests = kCurvedSampling.NumTests(superpixel.num_pixels);
  ForParts(superpixel.tests, [&](const SampleRange& part, float* depths) {
    ComputeDepths(surface, tests_, part, depths);
    for (size_t i = 0; i < part.count; ++i) {
      if (!(depths[i] > 0.f)) {
        ++sum.num_impossible;
        continue;
      }
      const Vec3f ray = {
          tests_.x[part.begin + i], tests_.y[part.begin + i], 1.f};
      AddVotes(sources_.data(),
               static_cast<int>(sources_.size()),
               ray * depths[i],
               max_gap,
               &sum);
    }
  });
  return sum;
}

bool SurfaceCosts::OpposesRegion(int s, const CurvedSurface& surface) const {
  std::vector<Observation> observations;
  for (int k = evidence_.first_observation[s];
       k < evidence_.first_observation[s + 1];
       ++k) {
    if (!evidence_.IsOfPrior(k)) {
      observations.push_back(evidence_.observations[k]);
    }
  }
  DepthSamples samples;
  const SampleRange range = samples.Add(observations, resolution_);
  std::vector<float> differences(range.PaddedCount());
  ComputeDifferences(surface, samples, range, differences.data());
  differences.resize(range.count);
  return std::ranges::any_of(differences, [&](float difference) {
    return difference > options_.labels.tolerance;
  });
}

LabelEvidence SurfaceCosts::EvidenceOf(const Superpixel& superpixel,
                                       const CurvedSurface& surface) const {
  if (superpixel.IsMeasured() && Measure(superpixel, surface).residual < 1.f) {
    return LabelEvidence::kMeasured;
  }
  return AskSources(superpixel, surface).num_confirmed > 0
             ? LabelEvidence::kCarried
             : LabelEvidence::kGuessed;
}

}  // namespace tsar
