// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/fit_curved_surface.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Cholesky>

namespace tsar {
namespace {

constexpr int kNumParameters = FittedSurface::kNumParameters;
using Vector6 = Eigen::Matrix<double, kNumParameters, 1>;
using Matrix6 = FittedSurface::Covariance;

constexpr int kFitIterations = 4;
// Depths are believed so far beyond those measured on the surface, as a share.
constexpr float kDepthMargin = 0.2f;

Vector6 Powers(double u, double v) {
  Vector6 powers;
  powers << 1.0, u, v, u * u, u * v, v * v;
  return powers;
}

// Calls body(observation) for all observations of superpixels.
template <typename Body>
void ForObservations(const SurfaceCosts& costs,
                     const std::vector<int>& members,
                     const Body& body) {
  for (const int s : members) {
    for (const Observation& observation : costs.At(s).observations) {
      body(observation);
    }
  }
}

// What a fit is relative to.
struct FitScale {
  double weights = 0.0;  // Of all observations together.
  double inverse_depth = 0.0;
  double extent = 0.0;
};

// Places the surface's polynomial in the middle of the observations. False
// where these do not extend.
bool PlaceSurface(const SurfaceCosts& costs,
                  const std::vector<int>& members,
                  CurvedSurface* surface,
                  FitScale* scale) {
  double x = 0.0;
  double y = 0.0;
  ForObservations(costs, members, [&](const Observation& observation) {
    const double weight = observation.confidence;
    scale->weights += weight;
    x += weight * observation.sample.x;
    y += weight * observation.sample.y;
    scale->inverse_depth += weight / observation.sample.z;
  });
  if (!(scale->weights > 0.0)) {
    return false;
  }
  surface->middle_x = static_cast<float>(x / scale->weights);
  surface->middle_y = static_cast<float>(y / scale->weights);
  scale->inverse_depth /= scale->weights;
  ForObservations(costs, members, [&](const Observation& observation) {
    scale->extent =
        std::max({scale->extent,
                  std::abs(static_cast<double>(observation.sample.x) -
                           surface->middle_x),
                  std::abs(static_cast<double>(observation.sample.y) -
                           surface->middle_y)});
  });
  surface->extent = static_cast<float>(scale->extent);
  return scale->extent > 0.0;
}

// Finds the coefficients and their covariance. False where there are none.
bool SolveCoefficients(const SurfaceCosts& costs,
                       const std::vector<int>& members,
                       const FitScale& scale,
                       FittedSurface* fitted) {
  const CurvedSurfaceOptions& options = costs.Options();
  CurvedSurface& surface = fitted->surface;
  double superpixel_weight = 0.0;
  for (const int s : members) {
    superpixel_weight += costs.At(s).weight;
  }
  const double inverse = scale.inverse_depth;
  const double sigma = options.noise_share * options.labels.tolerance;
  const double share =
      superpixel_weight / (scale.weights * options.pixels_per_observation);
  Vector6 coefficients = Vector6::Zero();
  for (int iteration = 0; iteration < kFitIterations; ++iteration) {
    Matrix6 normal = Matrix6::Identity() * 1e-9;
    Vector6 right = Vector6::Zero();
    ForObservations(costs, members, [&](const Observation& observation) {
      const RayDepth& sample = observation.sample;
      const Vector6 powers =
          Powers((sample.x - surface.middle_x) / scale.extent,
                 (sample.y - surface.middle_y) / scale.extent);
      const double measured = 1.0 / (sample.z * inverse);
      const double error =
          measured * costs.Resolution().RelativeDepthError(sample.z) * sigma;
      double weight = observation.confidence * share / (error * error);
      if (iteration > 0) {
        const double residual = (measured - powers.dot(coefficients)) / error;
        weight /= 1.0 + residual * residual;
      }
      normal.selfadjointView<Eigen::Lower>().rankUpdate(powers, weight);
      right += weight * measured * powers;
    });
    const Matrix6 full = normal.selfadjointView<Eigen::Lower>();
    const Eigen::LDLT<Matrix6> solver(full);
    coefficients = solver.solve(right);
    if (iteration + 1 == kFitIterations) {
      fitted->covariance =
          solver.solve(Matrix6::Identity()) * (inverse * inverse);
    }
  }
  for (int i = 0; i < kNumParameters; ++i) {
    surface.coefficients[i] = static_cast<float>(coefficients(i) * inverse);
  }
  return coefficients.allFinite();
}

}  // namespace

std::optional<FittedSurface> FitCurvedSurface(const SurfaceCosts& costs,
                                              const std::vector<int>& members) {
  FittedSurface fitted;
  FitScale scale;
  if (!PlaceSurface(costs, members, &fitted.surface, &scale) ||
      !SolveCoefficients(costs, members, scale, &fitted)) {
    return std::nullopt;
  }
  fitted.min_depth = INFINITY;
  ForObservations(costs, members, [&](const Observation& observation) {
    if (costs.Difference(observation.sample, fitted.surface) <
        costs.Options().labels.tolerance) {
      fitted.min_depth = std::min(fitted.min_depth, observation.sample.z);
      fitted.max_depth = std::max(fitted.max_depth, observation.sample.z);
    }
  });
  if (!(fitted.max_depth > 0.f)) {
    return std::nullopt;
  }
  return fitted;
}

bool IsKnown(const FittedSurface& fitted,
             const SurfaceCosts& costs,
             const Superpixel& superpixel) {
  const int num_pixels = static_cast<int>(superpixel.pixels.size());
  const int num_tests = kCurvedSampling.NumTests(num_pixels);
  const CurvedSurface& surface = fitted.surface;
  for (int i = 0; i < num_tests && num_pixels > 0; ++i) {
    const Vec3f ray = costs.RayOf(superpixel.pixels[static_cast<size_t>(
        VoteSampling::Pixel(i, num_tests, num_pixels))]);
    const Plane plane = surface.TangentAt(ray);
    if (!plane.Valid() ||
        !(-Dot(plane.normal, ray) > costs.Options().min_slope * Norm(ray))) {
      return false;
    }
    const float depth = plane.Depth(ray);
    if (!(depth > fitted.min_depth * (1.f - kDepthMargin) &&
          depth < fitted.max_depth * (1.f + kDepthMargin))) {
      return false;
    }
    const Vector6 powers = Powers((ray.x - surface.middle_x) / surface.extent,
                                  (ray.y - surface.middle_y) / surface.extent);
    const double sigma = std::sqrt(powers.dot(fitted.covariance * powers)) *
                         depth / costs.Resolution().RelativeDepthError(depth);
    if (!(sigma < costs.Options().labels.max_sigma)) {
      return false;
    }
  }
  return true;
}

}  // namespace tsar
