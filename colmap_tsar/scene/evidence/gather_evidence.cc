// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/scene/evidence/observe_pixels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <map>
#include <utility>

namespace tsar {
namespace {

// The ratio of standard deviation to median of absolute normal errors.
constexpr float kMedianToSigma = 1.48f;
// The largest number of observations of a superpixel that are of a prior.
constexpr int kMaxPriorsPerSuperpixel = 12;
// The weight of a pair of pixels across a border is
// kBorderBase + kBorderContrast exp(-edge / kBorderScale), edge in gray levels.
constexpr float kBorderBase = 0.05f;
constexpr float kBorderContrast = 2.f;
constexpr float kBorderScale = 4.f;
// The stride in both directions at which a superpixel's pixels are sampled.
constexpr int kPriorStride = 2;
// The largest standard deviation of a prior that is used.
constexpr float kMaxPriorSigma = 0.1f;
// The largest residual of a neighbor's depths at a superpixel's plane that they
// continue.
constexpr double kContinues = 0.02;

// The pixels i of each superpixel where is_wanted(i), in raster order.
template <typename Function>
std::vector<std::vector<int>> PixelsOfSuperpixels(const Image<int>& superpixels,
                                                  int num_superpixels,
                                                  const Function& is_wanted) {
  std::vector<std::vector<int>> pixels(num_superpixels);
  for (size_t i = 0; i < superpixels.NumPixels(); ++i) {
    if (is_wanted(i)) {
      pixels[superpixels.Data()[i]].push_back(static_cast<int>(i));
    }
  }
  return pixels;
}

// Element i of `count` evenly spaced ones among `size`.
size_t Spaced(size_t i, size_t count, size_t size) {
  return (2 * i + 1) * size / (2 * count);
}

// Adds an evenly spaced sample of some pixels' observations, with confidences
// scaled by `share`. Returns the sum of these.
float AddSample(const Image<PixelObservation>& observed,
                const std::vector<int>& pixels,
                size_t count,
                float share,
                ViewEvidence* evidence) {
  float sum = 0.f;
  for (size_t i = 0; i < count; ++i) {
    PixelObservation pixel =
        observed.Data()[pixels[Spaced(i, count, pixels.size())]];
    pixel.observation.confidence *= share;
    sum += pixel.observation.confidence;
    evidence->observations.push_back(pixel.observation);
    evidence->sources.push_back(pixel.source);
    evidence->errors.push_back(pixel.error);
  }
  return sum;
}

float SumOfConfidences(const Image<PixelObservation>& observed,
                       const std::vector<int>& pixels) {
  float sum = 0.f;
  for (const int pixel : pixels) {
    sum += observed.Data()[pixel].observation.confidence;
  }
  return sum;
}

void AddObservations(const EvidenceInputs& inputs,
                     const RegionCandidates& regions,
                     ViewEvidence* evidence) {
  const Image<PixelObservation> observed =
      ObservePixels(inputs, regions, &evidence->confident_depth);
  const auto pixels_of = [&](bool is_prior) {
    return PixelsOfSuperpixels(
        inputs.superpixels, inputs.num_superpixels, [&](size_t i) {
          const PixelObservation& pixel = observed.Data()[i];
          return pixel.observation.confidence > 0.f &&
                 (pixel.source == ObservationSource::kPrior) == is_prior;
        });
  };
  const std::vector<std::vector<int>> own = pixels_of(false);
  const std::vector<std::vector<int>> of_prior = pixels_of(true);
  evidence->first_observation.push_back(0);
  for (size_t k = 0; k < own.size(); ++k) {
    const float own_weight = SumOfConfidences(observed, own[k]);
    const float prior_weight = SumOfConfidences(observed, of_prior[k]);
    evidence->weights.push_back(own_weight + prior_weight);
    const float sampled = AddSample(
        observed,
        own[k],
        std::min(own[k].size(), size_t{kMaxObservationsPerSuperpixel}),
        1.f,
        evidence);
    const size_t count =
        std::min(of_prior[k].size(), size_t{kMaxPriorsPerSuperpixel});
    // Both kinds have the same relative weights in the sample as in the
    // superpixel.
    const float rate = own_weight > 0.f ? sampled / own_weight : 1.f;
    AddSample(observed,
              of_prior[k],
              count,
              rate * static_cast<float>(of_prior[k].size()) /
                  static_cast<float>(std::max<size_t>(count, 1)),
              evidence);
    evidence->first_observation.push_back(
        static_cast<int>(evidence->observations.size()));
  }
  if (inputs.prior.Empty()) {
    evidence->errors.clear();
  }
}

void AddConfirmed(const EvidenceInputs& inputs, ViewEvidence* evidence) {
  const Image<RayDepth>& confirmed = inputs.confirmed_samples;
  const std::vector<std::vector<int>> only_confirmed = PixelsOfSuperpixels(
      inputs.superpixels, inputs.num_superpixels, [&](size_t i) {
        return !confirmed.Empty() && IsMeasured(confirmed.Data()[i]) &&
               !IsMeasured(inputs.samples.Data()[i]);
      });
  evidence->first_confirmed.push_back(0);
  for (const std::vector<int>& pixels : only_confirmed) {
    const size_t count =
        std::min(pixels.size(), size_t{kMaxConfirmedPerSuperpixel});
    for (size_t i = 0; i < count; ++i) {
      evidence->confirmed.push_back(
          confirmed.Data()[pixels[Spaced(i, count, pixels.size())]]);
    }
    evidence->first_confirmed.push_back(
        static_cast<int>(evidence->confirmed.size()));
    evidence->confirmed_pixels.push_back(static_cast<int>(pixels.size()));
  }
}

// The pairs of neighboring pixels with different labels.
struct BorderPixels {
  float weight = 0.f;
  std::vector<int> pixels;  // On the side of the smaller label.
};

void AddBorders(const EvidenceInputs& inputs, ViewEvidence* evidence) {
  const Image<int>& labels = inputs.superpixels;
  std::vector<std::map<int, BorderPixels>> borders(inputs.num_superpixels);
  const auto add = [&](size_t pixel, size_t neighbor) {
    int first = labels.Data()[pixel];
    int second = labels.Data()[neighbor];
    if (first == second) {
      return;
    }
    const float edge = std::max(inputs.contrast.Data()[pixel],
                                inputs.contrast.Data()[neighbor]);
    if (first > second) {
      std::swap(first, second);
      std::swap(pixel, neighbor);
    }
    BorderPixels& border = borders[first][second];
    border.weight +=
        kBorderBase + kBorderContrast * std::exp(-edge / kBorderScale);
    border.pixels.push_back(static_cast<int>(pixel));
  };
  for (int y = 0; y < labels.Height(); ++y) {
    for (int x = 0; x < labels.Width(); ++x) {
      const size_t pixel = labels.View().Index(x, y);
      if (x + 1 < labels.Width()) {
        add(pixel, pixel + 1);
      }
      if (y + 1 < labels.Height()) {
        add(pixel, pixel + labels.Width());
      }
    }
  }
  for (size_t first = 0; first < borders.size(); ++first) {
    for (const auto& [second, border] : borders[first]) {
      SuperpixelBorder entry{static_cast<int>(first), second, border.weight};
      for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
        entry.pixels[i] = border.pixels[Spaced(
            i, SuperpixelBorder::kNumPixels, border.pixels.size())];
      }
      evidence->borders.push_back(entry);
    }
  }
}

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

float MeasureNoise(const EvidenceInputs& inputs) {
  std::vector<float> residuals;
  for (size_t i = 0; i < inputs.samples.NumPixels(); ++i) {
    const RayDepth& sample = inputs.samples.Data()[i];
    const Plane& plane = inputs.superpixel_planes[inputs.superpixels.Data()[i]];
    if (IsMeasured(sample) && plane.Valid()) {
      residuals.push_back(Residual(sample, plane, inputs.resolution));
    }
  }
  return residuals.empty() ? 0.f : kMedianToSigma * UpperMedian(&residuals);
}

Image<RayDepth> SamplesToAlignBy(Image<RayDepth> samples,
                                 const Image<float>& texture,
                                 const Image<float>& fattening_weight) {
  constexpr float kMinOwnTexture = 0.5f;
  for (size_t i = 0; i < samples.NumPixels(); ++i) {
    if (!(texture.Data()[i] > kMinTexture) ||
        (!fattening_weight.Empty() &&
         fattening_weight.Data()[i] < kMinOwnTexture)) {
      samples.Data()[i] = {};
    }
  }
  return samples;
}

GatheredEvidence GatherEvidence(const EvidenceInputs& inputs) {
  GatheredEvidence gathered;
  ViewEvidence& evidence = gathered.evidence;
  evidence.width = inputs.superpixels.Width();
  evidence.height = inputs.superpixels.Height();
  evidence.intrinsics = inputs.intrinsics;
  evidence.resolution = inputs.resolution;
  evidence.noise = MeasureNoise(inputs);
  evidence.superpixels = Image<uint16_t>(evidence.width, evidence.height);
  std::copy(inputs.superpixels.begin(),
            inputs.superpixels.end(),
            evidence.superpixels.begin());
  const RegionCandidates regions = FindRegionCandidates(inputs);
  AddObservations(inputs, regions, &evidence);
  AddConfirmed(inputs, &evidence);
  AddBorders(inputs, &evidence);
  evidence.prior = inputs.prior;
  evidence.candidates = regions.planes;
  std::copy_if(inputs.superpixel_planes.begin(),
               inputs.superpixel_planes.end(),
               std::back_inserter(evidence.candidates),
               [](const Plane& plane) { return plane.Valid(); });
  const std::vector<Plane> of_prior = ProposePlanesOfPrior(evidence);
  evidence.candidates.insert(
      evidence.candidates.end(), of_prior.begin(), of_prior.end());
  gathered.num_region_planes = static_cast<int>(regions.planes.size());
  return gathered;
}

std::vector<Plane> ProposePlanesOfPrior(const ViewEvidence& evidence) {
  const AlignedPrior& prior = evidence.prior;
  if (prior.Empty()) {
    return {};
  }
  std::vector<PriorOfSuperpixel> superpixels(evidence.weights.size());
  for (int y = 0; y < evidence.height; y += kPriorStride) {
    for (int x = 0; x < evidence.width; x += kPriorStride) {
      const float depth = prior.depth(x, y);
      if (!(depth > 0.f) || prior.sigma(x, y) > kMaxPriorSigma) {
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
    const int first = border.first;
    const int second = border.second;
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
