// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/surface_costs.h"

#include <algorithm>
#include <cmath>

namespace tsar {
namespace {

float DepthAt(const CurvedSurface& surface, const Vec3f& ray) {
  const Plane plane = surface.TangentAt(ray);
  return plane.Valid() ? plane.Depth(ray) : 0.f;
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
  superpixels_.resize(static_cast<size_t>(evidence_.NumSuperpixels()));
  for (size_t i = 0; i < evidence_.superpixels.NumPixels(); ++i) {
    superpixels_[evidence_.superpixels.Data()[i]].pixels.push_back(
        static_cast<int>(i));
  }
  for (const SuperpixelBorder& border : evidence_.borders) {
    superpixels_[static_cast<size_t>(border.first)].neighbors.push_back(
        border.second);
    superpixels_[static_cast<size_t>(border.second)].neighbors.push_back(
        border.first);
  }
  for (int s = 0; s < evidence_.NumSuperpixels(); ++s) {
    Superpixel& superpixel = superpixels_[static_cast<size_t>(s)];
    std::sort(superpixel.neighbors.begin(), superpixel.neighbors.end());
    AddObservations(s, &superpixel);
    Vec3f sum;
    for (const int pixel : superpixel.pixels) {
      sum = sum + RayOf(pixel);
    }
    if (!superpixel.pixels.empty()) {
      superpixel.middle = sum * (1.f / sum.z);
    }
    SetPresentCost(LabelOf(s), &superpixel);
  }
}

void SurfaceCosts::AddObservations(int s, Superpixel* superpixel) const {
  const auto i = static_cast<size_t>(s);
  float all = 0.f;
  for (int k = evidence_.first_observation[i];
       k < evidence_.first_observation[i + 1];
       ++k) {
    const Observation& observation =
        evidence_.observations[static_cast<size_t>(k)];
    all += observation.confidence;
    if (observation.confidence >= options_.min_confidence) {
      superpixel->observations.push_back(observation);
      superpixel->confidence += observation.confidence;
    }
  }
  superpixel->weight =
      all > 0.f ? evidence_.weights[i] * superpixel->confidence / all : 0.f;
  const auto num_pixels = static_cast<float>(superpixel->pixels.size());
  if (superpixel->weight < options_.min_measured * num_pixels) {
    superpixel->observations.clear();
    superpixel->confidence = 0.f;
    superpixel->weight = 0.f;
  }
}

void SurfaceCosts::SetPresentCost(int label, Superpixel* superpixel) const {
  const LabelOptions& labels = options_.labels;
  if (label < 0) {
    superpixel->residual = labels.cost_of_unexplained;
    superpixel->cost =
        superpixel->weight * superpixel->residual +
        labels.unlabelled_cost *
            std::max(static_cast<float>(superpixel->pixels.size()) -
                         superpixel->weight,
                     0.f);
    return;
  }
  const CurvedSurface surface = PlaneSurface(label);
  superpixel->residual = Residual(*superpixel, surface);
  superpixel->cost = Cost(*superpixel, surface);
}

CurvedSurface SurfaceCosts::PlaneSurface(int label) const {
  const Plane& plane = labeled_.planes[static_cast<size_t>(label)];
  CurvedSurface surface;
  surface.coefficients[0] = -plane.normal.z / plane.offset;
  surface.coefficients[1] = -plane.normal.x / plane.offset;
  surface.coefficients[2] = -plane.normal.y / plane.offset;
  return surface;
}

float SurfaceCosts::Difference(const RayDepth& sample,
                               const CurvedSurface& surface) const {
  const float depth = DepthAt(surface, {sample.x, sample.y, 1.f});
  return depth > 0.f ? std::abs(depth - sample.z) /
                           (sample.z * resolution_.RelativeDepthError(sample.z))
                     : INFINITY;
}

float SurfaceCosts::Residual(const Superpixel& superpixel,
                             const CurvedSurface& surface) const {
  float sum = 0.f;
  for (const Observation& observation : superpixel.observations) {
    const float share = std::min(
        Difference(observation.sample, surface) / options_.labels.tolerance,
        1.f);
    sum += observation.confidence * share * share;
  }
  return superpixel.confidence > 0.f ? sum / superpixel.confidence : 1.f;
}

float SurfaceCosts::ResidualOfNearest(
    const Superpixel& superpixel,
    const std::vector<CurvedSurface>& planes) const {
  float sum = 0.f;
  for (const Observation& observation : superpixel.observations) {
    float share = 1.f;
    for (const CurvedSurface& plane : planes) {
      share = std::min(
          share,
          Difference(observation.sample, plane) / options_.labels.tolerance);
    }
    sum += observation.confidence * share * share;
  }
  return sum / superpixel.confidence;
}

float SurfaceCosts::Cost(const Superpixel& superpixel,
                         const CurvedSurface& surface) const {
  const LabelOptions& labels = options_.labels;
  const SuperpixelVotes sum = AskSources(superpixel, surface);
  const float pixels_per_vote = static_cast<float>(superpixel.pixels.size()) /
                                static_cast<float>(sum.num_tests * kMaxVotes);
  const float seen =
      labels.cost_of_contradiction *
          static_cast<float>(sum.votes.contradicted) -
      labels.gain_of_confirmation * static_cast<float>(sum.votes.confirmed);
  return (superpixel.IsMeasured()
              ? superpixel.weight * Residual(superpixel, surface)
              : 0.f) +
         seen * pixels_per_vote;
}

SuperpixelVotes SurfaceCosts::AskSources(const Superpixel& superpixel,
                                         const CurvedSurface& surface) const {
  return CollectVotes(
      static_cast<int>(superpixel.pixels.size()),
      kCurvedSampling,
      sources_.data(),
      static_cast<int>(sources_.size()),
      {options_.labels.confirmation_share * options_.labels.tolerance,
       options_.labels.min_contradiction},
      [&](int number, Vec3f* point) {
        const Vec3f ray = RayOf(superpixel.pixels[static_cast<size_t>(number)]);
        const float depth = DepthAt(surface, ray);
        *point = ray * depth;
        return depth > 0.f;
      });
}

bool SurfaceCosts::OpposesRegion(int s, const CurvedSurface& surface) const {
  const auto i = static_cast<size_t>(s);
  const auto begin = evidence_.observations.begin();
  return std::any_of(begin + evidence_.first_observation[i],
                     begin + evidence_.first_observation[i + 1],
                     [&](const Observation& observation) {
                       return Difference(observation.sample, surface) >
                              options_.labels.tolerance;
                     });
}

LabelEvidence SurfaceCosts::EvidenceOf(const Superpixel& superpixel,
                                       const CurvedSurface& surface) const {
  if (superpixel.IsMeasured() && Residual(superpixel, surface) < 1.f) {
    return LabelEvidence::kMeasured;
  }
  return AskSources(superpixel, surface).votes.confirmed > 0
             ? LabelEvidence::kCarried
             : LabelEvidence::kGuessed;
}

}  // namespace tsar
