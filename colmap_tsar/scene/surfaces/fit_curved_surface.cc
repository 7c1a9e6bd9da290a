// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/fit_curved_surface.h"

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
// The share by which possible depths extend beyond those measured on the
// surface.
constexpr float kDepthMargin = 0.2f;

Vector6 Monomials(double u, double v) {
  Vector6 monomials;
  monomials << 1.0, u, v, u * u, u * v, v * v;
  return monomials;
}

// The values that loops over samples process at a time.
using Several = Eigen::Array<double, SampleRange::kAlignment, 1>;

auto SeveralAt(const std::vector<float>& values, size_t begin) {
  return Eigen::Array<float, SampleRange::kAlignment, 1>::Map(&values[begin]);
}

// The units of a fit.
struct FitScale {
  double weights = 0.0;  // Sum over all samples.
  double inverse_depth = 0.0;
  double extent = 0.0;
};

// Centers the surface's polynomial on the samples. Returns false if these have
// no extent.
bool CenterPolynomial(const SurfaceCosts& costs,
                      const std::vector<int>& members,
                      CurvedSurface* surface,
                      FitScale* scale) {
  const DepthSamples& samples = costs.Samples();
  double x = 0.0;
  double y = 0.0;
  float min_x = INFINITY;
  float max_x = -INFINITY;
  float min_y = INFINITY;
  float max_y = -INFINITY;
  for (const int s : members) {
    const SampleRange& range = costs.At(s).samples;
    for (size_t i = range.begin; i < range.begin + range.count; ++i) {
      const double weight = samples.confidence[i];
      scale->weights += weight;
      x += weight * samples.rays.x[i];
      y += weight * samples.rays.y[i];
      scale->inverse_depth += weight / samples.depth[i];
      min_x = std::min(min_x, samples.rays.x[i]);
      max_x = std::max(max_x, samples.rays.x[i]);
      min_y = std::min(min_y, samples.rays.y[i]);
      max_y = std::max(max_y, samples.rays.y[i]);
    }
  }
  if (!(scale->weights > 0.0)) {
    return false;
  }
  surface->middle_x = static_cast<float>(x / scale->weights);
  surface->middle_y = static_cast<float>(y / scale->weights);
  scale->inverse_depth /= scale->weights;
  scale->extent = std::max({double{max_x} - surface->middle_x,
                            surface->middle_x - double{min_x},
                            double{max_y} - surface->middle_y,
                            surface->middle_y - double{min_y}});
  surface->extent = static_cast<float>(scale->extent);
  return scale->extent > 0.0;
}

// The equations of a fit, one for each sample: monomials . coefficients =
// measured
// +- error, in units of FitScale.
class FitEquations {
 public:
  FitEquations(const SurfaceCosts& costs,
               const std::vector<int>& members,
               const CurvedSurface& surface,
               const FitScale& scale) {
    const CurvedSurfaceOptions& options = costs.Options();
    const DepthSamples& samples = costs.Samples();
    double superpixel_weight = 0.0;
    for (const int s : members) {
      superpixel_weight += costs.At(s).weight;
      size_ += costs.At(s).samples.count;
    }
    const double sigma = options.noise_share * options.labels.tolerance;
    const double share =
        superpixel_weight / (scale.weights * options.pixels_per_observation);
    const size_t padded_size = size_ + SampleRange::kAlignment;
    monomials_.resize(padded_size);
    for (std::vector<double>* values :
         {&measured_, &errors_, &full_weights_, &weights_}) {
      values->resize(padded_size);
    }
    size_t first = 0;
    for (const int s : members) {
      const SampleRange& range = costs.At(s).samples;
      // Values beyond the end of a range are overwritten by the next one.
      for (size_t i = 0; i < range.PaddedCount();
           i += SampleRange::kAlignment) {
        const size_t from = range.begin + i;
        const size_t to = first + i;
        const Several u = (SeveralAt(samples.rays.x, from) - surface.middle_x)
                              .cast<double>() /
                          scale.extent;
        const Several v = (SeveralAt(samples.rays.y, from) - surface.middle_y)
                              .cast<double>() /
                          scale.extent;
        const Several measured =
            1.0 / (SeveralAt(samples.depth, from).cast<double>() *
                   scale.inverse_depth);
        const Several error =
            measured * SeveralAt(samples.relative_error, from).cast<double>() *
            sigma;
        Several::Map(&measured_[to]) = measured;
        Several::Map(&errors_[to]) = error;
        Several::Map(&full_weights_[to]) =
            SeveralAt(samples.confidence, from).cast<double>() * share /
            (error * error);
        for (size_t j = 0; j < SampleRange::kAlignment; ++j) {
          monomials_[to + j] = Monomials(u(j), v(j));
        }
      }
      first += range.count;
    }
  }

  // Solves with weights that are smaller where `weighted_by` fits worse, if
  // given. The lower triangle of the normal matrix is summed by columns, in
  // locals of fixed size, which stay in registers. Some extend above the
  // diagonal to fill registers.
  Eigen::LDLT<Matrix6> Solve(const Vector6* weighted_by,
                             Vector6* coefficients) {
    if (weighted_by != nullptr) {
      SetWeights(*weighted_by);
    } else {
      weights_ = full_weights_;
    }
    Matrix6 normal = Matrix6::Identity() * 1e-9;
    Vector6 column0 = normal.col(0);
    Vector6 column1 = normal.col(1);
    Eigen::Vector4d column2 = normal.col(2).tail<4>();
    Eigen::Vector4d column3 = normal.col(3).tail<4>();
    Eigen::Vector2d column4 = normal.col(4).tail<2>();
    Eigen::Vector2d column5 = normal.col(5).tail<2>();
    Vector6 right = Vector6::Zero();
    for (size_t k = 0; k < size_; ++k) {
      const Vector6& monomials = monomials_[k];
      const double weight = weights_[k];
      column0 += weight * monomials;
      column1 += (weight * monomials(1)) * monomials;
      column2 += (weight * monomials(2)) * monomials.tail<4>();
      column3 += (weight * monomials(3)) * monomials.tail<4>();
      column4 += (weight * monomials(4)) * monomials.tail<2>();
      column5 += (weight * monomials(5)) * monomials.tail<2>();
      right += (weight * measured_[k]) * monomials;
    }
    normal.col(0) = column0;
    normal.col(1) = column1;
    normal.col(2).tail<4>() = column2;
    normal.col(3).tail<4>() = column3;
    normal.col(4).tail<2>() = column4;
    normal.col(5).tail<2>() = column5;
    const Matrix6 full = normal.selfadjointView<Eigen::Lower>();
    Eigen::LDLT<Matrix6> solver(full);
    *coefficients = solver.solve(right);
    return solver;
  }

 private:
  void SetWeights(const Vector6& coefficients) {
    for (size_t k = 0; k < size_; ++k) {
      weights_[k] = monomials_[k].dot(coefficients);
    }
    const double* measured = measured_.data();
    const double* errors = errors_.data();
    const double* full_weights = full_weights_.data();
    double* weights = weights_.data();
    for (size_t k = 0; k < size_; ++k) {
      const double residual = (measured[k] - weights[k]) / errors[k];
      weights[k] = full_weights[k] / (1.0 + residual * residual);
    }
  }

  size_t size_ = 0;
  std::vector<Vector6> monomials_;
  std::vector<double> measured_;
  std::vector<double> errors_;
  std::vector<double> full_weights_;  // Weights at a residual of 0.
  std::vector<double> weights_;
};

// Finds the coefficients and their covariance. Returns false if there is no
// solution.
bool SolveCoefficients(FitEquations equations,
                       double inverse_depth,
                       FittedSurface* fitted) {
  Vector6 coefficients;
  equations.Solve(nullptr, &coefficients);
  for (int i = 1; i + 1 < kFitIterations; ++i) {
    equations.Solve(&coefficients, &coefficients);
  }
  fitted->covariance =
      equations.Solve(&coefficients, &coefficients).solve(Matrix6::Identity()) *
      (inverse_depth * inverse_depth);
  for (int i = 0; i < kNumParameters; ++i) {
    fitted->surface.coefficients[i] =
        static_cast<float>(coefficients(i) * inverse_depth);
  }
  return coefficients.allFinite();
}

}  // namespace

std::optional<FittedSurface> FitCurvedSurface(const SurfaceCosts& costs,
                                              const std::vector<int>& members,
                                              std::vector<float>* residuals) {
  FittedSurface fitted;
  FitScale scale;
  if (!CenterPolynomial(costs, members, &fitted.surface, &scale) ||
      !SolveCoefficients(FitEquations(costs, members, fitted.surface, scale),
                         scale.inverse_depth,
                         &fitted)) {
    return std::nullopt;
  }
  fitted.min_depth = INFINITY;
  residuals->clear();
  for (const int s : members) {
    const MeasuredFit fit = costs.Measure(costs.At(s), fitted.surface);
    fitted.min_depth = std::min(fitted.min_depth, fit.min_depth);
    fitted.max_depth = std::max(fitted.max_depth, fit.max_depth);
    residuals->push_back(fit.residual);
  }
  if (!(fitted.max_depth > 0.f)) {
    return std::nullopt;
  }
  return fitted;
}

bool IsKnown(const FittedSurface& fitted,
             const SurfaceCosts& costs,
             const Superpixel& superpixel) {
  const RaySamples& tests = costs.Tests();
  const SampleRange& range = superpixel.tests;
  const CurvedSurface& surface = fitted.surface;
  for (size_t i = range.begin; i < range.begin + range.count; ++i) {
    const Vec3f ray = {tests.x[i], tests.y[i], 1.f};
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
    const Vector6 monomials =
        Monomials((ray.x - surface.middle_x) / surface.extent,
                  (ray.y - surface.middle_y) / surface.extent);
    const double sigma =
        std::sqrt(monomials.dot(fitted.covariance * monomials)) * depth /
        costs.Resolution().RelativeDepthError(depth);
    if (!(sigma < costs.Options().labels.max_sigma)) {
      return false;
    }
  }
  return true;
}

}  // namespace tsar
