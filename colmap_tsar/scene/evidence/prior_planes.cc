// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/prior_planes.h"

#include "colmap_tsar/base/plane_fit.h"

#include <cmath>
#include <cstddef>

namespace tsar {
namespace {

// The stride in both directions at which a superpixel's pixels are sampled.
constexpr int kStride = 2;
// The largest standard deviation of a prior that is used.
constexpr float kMaxSigma = 0.1f;
// The largest residual of a neighbor's depths at a superpixel's plane that they
// continue.
constexpr double kContinues = 0.02;

struct PriorOfSuperpixel {
  PlaneRegression regression;
  Plane plane;
  // The means of its rays and inverse depths.
  double x = 0.0;
  double y = 0.0;
  double inverse_depth = 0.0;
  int count = 0;
};

bool Continues(const PriorOfSuperpixel& superpixel,
               const PriorOfSuperpixel& neighbor) {
  if (!superpixel.plane.Valid() || neighbor.count == 0) {
    return false;
  }
  const float depth = superpixel.plane.Depth(
      {static_cast<float>(neighbor.x), static_cast<float>(neighbor.y), 1.f});
  return depth > 0.f &&
         std::abs(depth * neighbor.inverse_depth - 1.0) < kContinues;
}

}  // namespace

std::vector<Plane> ProposePlanesOfPrior(const ViewEvidence& evidence) {
  const AlignedPrior& prior = evidence.prior;
  if (prior.Empty()) {
    return {};
  }
  std::vector<PriorOfSuperpixel> superpixels(evidence.weights.size());
  for (int y = 0; y < evidence.height; y += kStride) {
    for (int x = 0; x < evidence.width; x += kStride) {
      const float depth = prior.depth(x, y);
      if (!(depth > 0.f) || prior.sigma(x, y) > kMaxSigma) {
        continue;
      }
      const Vec3f ray = evidence.intrinsics.Ray(x, y);
      PriorOfSuperpixel& superpixel = superpixels[evidence.superpixels(x, y)];
      superpixel.regression.Add({ray.x, ray.y, depth}, 1.0);
      superpixel.x += ray.x;
      superpixel.y += ray.y;
      superpixel.inverse_depth += 1.0 / depth;
      ++superpixel.count;
    }
  }
  std::vector<PlaneRegression> joint;
  for (PriorOfSuperpixel& superpixel : superpixels) {
    joint.push_back(superpixel.regression);
    if (superpixel.count > 0) {
      superpixel.plane = superpixel.regression.Solve();
      superpixel.x /= superpixel.count;
      superpixel.y /= superpixel.count;
      superpixel.inverse_depth /= superpixel.count;
    }
  }
  for (const SuperpixelBorder& border : evidence.borders) {
    const auto first = static_cast<size_t>(border.first);
    const auto second = static_cast<size_t>(border.second);
    if (Continues(superpixels[first], superpixels[second]) &&
        Continues(superpixels[second], superpixels[first])) {
      joint[first] += superpixels[second].regression;
      joint[second] += superpixels[first].regression;
    }
  }
  std::vector<Plane> planes;
  for (const PlaneRegression& regression : joint) {
    const Plane plane = regression.Solve();
    if (plane.Valid()) {
      planes.push_back(plane);
    }
  }
  return planes;
}

}  // namespace tsar
