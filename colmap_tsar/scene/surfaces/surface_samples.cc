// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/surface_samples.h"

#include <cmath>

namespace tsar {
namespace {

void Pad(float value, std::vector<float>* values) {
  while (values->size() % SampleRange::kAlignment != 0) {
    values->push_back(value);
  }
}

float DepthAt(const CurvedSurface& surface, float x, float y) {
  const Vec3f ray = {x, y, 1.f};
  const Plane plane = surface.TangentAt(ray);
  return plane.Valid() ? plane.Depth(ray) : 0.f;
}

}  // namespace

SampleRange RaySamples::Add(const std::vector<Vec3f>& rays) {
  const SampleRange range = {x.size(), rays.size()};
  for (const Vec3f& ray : rays) {
    x.push_back(ray.x);
    y.push_back(ray.y);
  }
  Pad(0.f, &x);
  Pad(0.f, &y);
  return range;
}

SampleRange DepthSamples::Add(const std::vector<Observation>& observations,
                              const DepthResolution& resolution) {
  std::vector<Vec3f> points;
  for (const Observation& observation : observations) {
    const RayDepth& sample = observation.sample;
    const float relative = resolution.RelativeDepthError(sample.z);
    points.push_back({sample.x, sample.y, 1.f});
    depth.push_back(sample.z);
    confidence.push_back(observation.confidence);
    relative_error.push_back(relative);
    error.push_back(sample.z * relative);
  }
  for (std::vector<float>* values :
       {&depth, &confidence, &relative_error, &error}) {
    Pad(1.f, values);
  }
  return rays.Add(points);
}

void ComputeDepths(const CurvedSurface& surface,
                   const RaySamples& rays,
                   const SampleRange& range,
                   float* depths) {
  const CurvedSurface copy = surface;
  const float* x = rays.x.data() + range.begin;
  const float* y = rays.y.data() + range.begin;
  const size_t count = range.PaddedCount();
  for (size_t i = 0; i < count; ++i) {
    depths[i] = DepthAt(copy, x[i], y[i]);
  }
}

void ComputeDifferences(const CurvedSurface& surface,
                        const DepthSamples& samples,
                        const SampleRange& range,
                        float* differences) {
  ComputeDepths(surface, samples.rays, range, differences);
  const float* depths = samples.depth.data() + range.begin;
  const float* errors = samples.error.data() + range.begin;
  const size_t count = range.PaddedCount();
  for (size_t i = 0; i < count; ++i) {
    const float depth = differences[i];
    const float difference = std::abs(depth - depths[i]) / errors[i];
    differences[i] = depth > 0.f ? difference : INFINITY;
  }
}

}  // namespace tsar
