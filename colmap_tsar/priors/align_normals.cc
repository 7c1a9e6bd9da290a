// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/priors/align_normals.h"

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/priors/fit_prior.h"
#include "colmap_tsar/priors/prior_likelihood.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tsar {
namespace {

constexpr size_t kMinPlanes = 20;
// The median of a Rayleigh distribution, which the angles between directions
// have, in standard deviations.
constexpr float kMedianInSigmas = 1.1774f;
// The largest error of a prior in use, as a share of that of the best constant
// direction, and the one (11 degrees) that is always small enough.
constexpr float kMaxShareOfConstant = 0.5f;
constexpr float kSmallSigma = 0.2f;
// Drawn normals may be exact, but planes are not.
constexpr float kMinSigma = 0.01f;

float Angle(const Vec3f& a, const Vec3f& b) {
  return std::acos(std::clamp(Dot(a, b), -1.f, 1.f));
}

std::vector<Vec3f> MeanNormals(const Image<Vec3f>& normals,
                               const Image<int>& superpixels,
                               size_t num_superpixels) {
  std::vector<Vec3f> means(num_superpixels);
  std::vector<int> num_pixels(num_superpixels);
  for (int y = 0; y < superpixels.Height(); ++y) {
    const int v = y * normals.Height() / superpixels.Height();
    for (int x = 0; x < superpixels.Width(); ++x) {
      const int u = x * normals.Width() / superpixels.Width();
      const auto label = static_cast<size_t>(superpixels(x, y));
      means[label] = means[label] + normals(u, v);
      ++num_pixels[label];
    }
  }
  for (size_t k = 0; k < num_superpixels; ++k) {
    means[k] =
        means[k] * (1.f / static_cast<float>(std::max(num_pixels[k], 1)));
  }
  return means;
}

// The superpixels of which at least half of the pixels have a sample.
std::vector<bool> AreMeasured(const Image<int>& superpixels,
                              const Image<RayDepth>& samples,
                              size_t num_superpixels) {
  std::vector<int> balance(num_superpixels);
  for (size_t i = 0; i < samples.NumPixels(); ++i) {
    balance[superpixels.Data()[i]] += samples.Data()[i].z > 0.f ? 1 : -1;
  }
  std::vector<bool> are_measured;
  for (const int difference : balance) {
    are_measured.push_back(difference >= 0);
  }
  return are_measured;
}

float SigmaOf(std::vector<float> angles) {
  return UpperMedian(&angles) / kMedianInSigmas;
}

}  // namespace

void AlignNormals(const Image<Vec3f>& normals,
                  const Image<int>& superpixels,
                  const std::vector<Plane>& planes,
                  const Image<RayDepth>& samples,
                  AlignedPrior* aligned) {
  PriorAssessment& assessment = aligned->assessment;
  if (normals.Empty()) {
    return;
  }
  std::vector<Vec3f> means = MeanNormals(normals, superpixels, planes.size());
  const std::vector<bool> are_measured =
      AreMeasured(superpixels, samples, planes.size());
  std::vector<size_t> measured;
  Vec3f sum;
  for (size_t k = 0; k < planes.size(); ++k) {
    if (are_measured[k] && planes[k].Valid() && AreOfOneSurface(means[k])) {
      measured.push_back(k);
      sum = sum + planes[k].normal;
    }
  }
  if (measured.size() < kMinPlanes) {
    assessment.of_normals = PriorVerdict::kFewMeasured;
    return;
  }
  const Vec3f constant = Normalized(sum);
  std::vector<float> errors;
  std::vector<float> errors_of_constant;
  for (const size_t k : measured) {
    errors.push_back(Angle(Normalized(means[k]), planes[k].normal));
    errors_of_constant.push_back(Angle(constant, planes[k].normal));
  }
  const float sigma = std::max(SigmaOf(errors), kMinSigma);
  assessment.normal_sigma = sigma;
  if (sigma > std::max(kSmallSigma,
                       kMaxShareOfConstant * SigmaOf(errors_of_constant))) {
    assessment.of_normals = PriorVerdict::kUnlike;
    return;
  }
  assessment.of_normals = PriorVerdict::kUsed;
  aligned->normal_outlier_share =
      BoundedOutlierShare(ShareOfOutliers(errors, sigma));
  aligned->normals = std::move(means);
}

}  // namespace tsar
