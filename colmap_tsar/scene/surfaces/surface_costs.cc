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
  constexpr int kLength = 64;
  static_assert(kLength % SampleRange::kAlignment == 0);
  std::array<float, kLength> values;
  for (int i = 0; i < range.count; i += kLength) {
    body(SampleRange{range.begin + i, std::min(kLength, range.count - i)},
         values.data());
  }
}

// Calls body(label, begin, end) for each run of pixels with the same label.
template <typename Body>
void ForRuns(const uint16_t* labels, size_t num_pixels, const Body& body) {
  size_t begin = 0;
  for (size_t i = 1; i <= num_pixels; ++i) {
    if (i == num_pixels || labels[i] != labels[begin]) {
      body(labels[begin], begin, i);
      begin = i;
    }
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
  superpixels_.resize(static_cast<size_t>(evidence_.NumSuperpixels()));
  for (const SuperpixelBorder& border : evidence_.borders) {
    superpixels_[border.first].neighbors.push_back(border.second);
    superpixels_[border.second].neighbors.push_back(border.first);
  }
  num_measured_.assign(labeled_.planes.size(), 0);
  for (int s = 0; s < evidence_.NumSuperpixels(); ++s) {
    Superpixel& superpixel = superpixels_[s];
    std::sort(superpixel.neighbors.begin(), superpixel.neighbors.end());
    superpixel.num_pixels =
        first_pixel_[static_cast<size_t>(s) + 1] - first_pixel_[s];
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
  present_costs_.assign(superpixels_.size(), NAN);
  shares_.resize(superpixels_.size());
}

void SurfaceCosts::ListPixels() {
  const uint16_t* labels = evidence_.superpixels.Data();
  const size_t num_pixels = evidence_.superpixels.NumPixels();
  first_pixel_.assign(static_cast<size_t>(evidence_.NumSuperpixels()) + 1, 0);
  ForRuns(labels, num_pixels, [&](uint16_t s, size_t begin, size_t end) {
    first_pixel_[s + size_t{1}] += static_cast<int>(end - begin);
  });
  for (size_t s = 1; s < first_pixel_.size(); ++s) {
    first_pixel_[s] += first_pixel_[s - 1];
  }
  std::vector<int> next = first_pixel_;
  pixels_.resize(num_pixels);
  ForRuns(labels, num_pixels, [&](uint16_t s, size_t begin, size_t end) {
    std::iota(pixels_.begin() + next[s],
              pixels_.begin() + next[s] + static_cast<int>(end - begin),
              static_cast<int>(begin));
    next[s] += static_cast<int>(end - begin);
  });
}

void SurfaceCosts::AddSamples(int s, Superpixel* superpixel) {
  const auto i = static_cast<size_t>(s);
  std::vector<Observation> observations;
  float all = 0.f;
  for (int k = evidence_.first_observation[i];
       k < evidence_.first_observation[i + 1];
       ++k) {
    const Observation& observation = evidence_.observations[k];
    all += observation.confidence;
    if (observation.confidence >= options_.min_confidence &&
        !evidence_.IsOfPrior(static_cast<size_t>(k))) {
      observations.push_back(observation);
      superpixel->confidence += observation.confidence;
    }
  }
  superpixel->weight =
      all > 0.f ? evidence_.weights[i] * superpixel->confidence / all : 0.f;
  const auto num_pixels = static_cast<float>(superpixel->num_pixels);
  if (superpixel->weight < options_.min_measured * num_pixels) {
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
  for (int k = first_pixel_[s]; k < first_pixel_[static_cast<size_t>(s) + 1];
       ++k) {
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
    for (size_t i = 0; i < part.Count(); ++i) {
      const float depth = samples_.depth[part.Begin() + i];
      if (values[i] < tolerance) {
        fit.min_depth = std::min(fit.min_depth, depth);
        fit.max_depth = std::max(fit.max_depth, depth);
      }
      const float share = std::min(values[i] / tolerance, 1.f);
      sum += samples_.confidence[part.Begin() + i] * share * share;
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
  std::vector<float> nearest(superpixel.samples.Count(), 1.f);
  for (const int plane : planes) {
    const std::vector<float>& shares = FindShares(s, plane);
    for (size_t i = 0; i < nearest.size(); ++i) {
      nearest[i] = std::min(nearest[i], shares[i]);
    }
  }
  float sum = 0.f;
  for (size_t i = 0; i < nearest.size(); ++i) {
    sum += samples_.confidence[superpixel.samples.Begin() + i] * nearest[i] *
           nearest[i];
  }
  return sum / superpixel.confidence;
}

const std::vector<float>& SurfaceCosts::FindShares(int s, int plane) const {
  std::vector<SharesOnPlane>& known = shares_[s];
  for (const SharesOnPlane& entry : known) {
    if (entry.plane == plane) {
      return entry.shares;
    }
  }
  const SampleRange& samples = At(s).samples;
  std::vector<float> shares(samples.PaddedCount());
  ComputeDifferences(PlaneSurface(plane), samples_, samples, shares.data());
  for (float& share : shares) {
    share /= options_.labels.tolerance;
  }
  known.push_back({plane, std::move(shares)});
  return known.back().shares;
}

float SurfaceCosts::PresentCost(int s) const {
  float& cost = present_costs_[s];
  if (!std::isnan(cost)) {
    return cost;
  }
  const Superpixel& superpixel = At(s);
  const LabelOptions& labels = options_.labels;
  if (LabelOf(s) < 0) {
    cost = superpixel.weight * superpixel.residual +
           labels.unlabeled_cost *
               std::max(static_cast<float>(superpixel.num_pixels) -
                            superpixel.weight,
                        0.f);
  } else {
    cost = Cost(superpixel, superpixel.residual);
  }
  return cost;
}

SuperpixelVotes SurfaceCosts::AskSources(const Superpixel& superpixel,
                                         const CurvedSurface& surface) const {
  const float max_gap =
      options_.labels.confirmation_share * options_.labels.tolerance;
  SuperpixelVotes sum;
  sum.num_tests = kCurvedSampling.NumTests(superpixel.num_pixels);
  ForParts(superpixel.tests, [&](const SampleRange& part, float* depths) {
    ComputeDepths(surface, tests_, part, depths);
    for (size_t i = 0; i < part.Count(); ++i) {
      if (!(depths[i] > 0.f)) {
        ++sum.num_impossible;
        continue;
      }
      const Vec3f ray = {
          tests_.x[part.Begin() + i], tests_.y[part.Begin() + i], 1.f};
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
  const auto i = static_cast<size_t>(s);
  std::vector<Observation> observations;
  for (int k = evidence_.first_observation[i];
       k < evidence_.first_observation[i + 1];
       ++k) {
    if (!evidence_.IsOfPrior(static_cast<size_t>(k))) {
      observations.push_back(evidence_.observations[k]);
    }
  }
  DepthSamples samples;
  const SampleRange range = samples.Add(observations, resolution_);
  std::vector<float> differences(range.PaddedCount());
  ComputeDifferences(surface, samples, range, differences.data());
  return std::any_of(
      differences.begin(),
      differences.begin() + range.count,
      [&](float difference) { return difference > options_.labels.tolerance; });
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
