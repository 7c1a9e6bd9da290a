// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include "colmap_tsar/base/median.h"
#include "colmap_tsar/scene/evidence/observe_pixels.h"
#include "colmap_tsar/scene/evidence/prior_planes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <map>
#include <unordered_map>
#include <utility>

namespace tsar {
namespace {

// The largest size in pixels of regions whose planes are no candidates: they
// are fragments beyond the reach of another plane.
constexpr int kMinCandidatePixels = 30;
// The ratio of standard deviation to median of absolute normal errors.
constexpr float kMedianToSigma = 1.48f;

struct PlaneBits {
  uint32_t bits[4];
  explicit PlaneBits(const Plane& plane) {
    static_assert(sizeof(Plane) == sizeof(bits));
    std::memcpy(bits, &plane, sizeof(bits));
  }
  bool operator==(const PlaneBits& other) const {
    return std::equal(bits, bits + 4, other.bits);
  }
};

struct PlaneBitsHash {
  size_t operator()(const PlaneBits& plane) const {
    size_t hash = 0;
    for (const uint32_t bits : plane.bits) {
      hash = hash * 1000003u ^ bits;
    }
    return hash;
  }
};

// Lists the distinct planes of the regions in the order of their first pixels;
// those of regions that are large enough become candidates.
RegionCandidates FindRegionCandidates(const EvidenceInputs& inputs) {
  RegionCandidates candidates;
  candidates.of_pixels =
      Image<uint16_t>(inputs.superpixels.Width(), inputs.superpixels.Height());
  const Image<Plane>& planes = inputs.region_planes;
  std::unordered_map<PlaneBits, int, PlaneBitsHash> indices;
  std::vector<std::pair<Plane, int>> found;  // Planes and numbers of pixels.
  Image<int> index_of(planes.Width(), planes.Height(), -1);
  for (size_t i = 0; i < planes.NumPixels(); ++i) {
    const Plane& plane = planes.Data()[i];
    if (!plane.Valid()) {
      continue;
    }
    const auto [entry, is_new] =
        indices.try_emplace(PlaneBits(plane), static_cast<int>(found.size()));
    if (is_new) {
      found.emplace_back(plane, 0);
    }
    ++found[static_cast<size_t>(entry->second)].second;
    index_of.Data()[i] = entry->second;
  }
  std::vector<uint16_t> candidate_of(found.size(), 0);
  for (size_t k = 0; k < found.size(); ++k) {
    if (found[k].second >= kMinCandidatePixels &&
        candidates.planes.size() < UINT16_MAX) {
      candidates.planes.push_back(found[k].first);
      candidate_of[k] = static_cast<uint16_t>(candidates.planes.size());
    }
  }
  for (size_t i = 0; i < planes.NumPixels(); ++i) {
    if (index_of.Data()[i] >= 0) {
      candidates.of_pixels.Data()[i] =
          candidate_of[static_cast<size_t>(index_of.Data()[i])];
    }
  }
  return candidates;
}

// The pixels i of each superpixel where is_wanted(i), in raster order.
template <typename Function>
std::vector<std::vector<int>> PixelsOfSuperpixels(const Image<int>& superpixels,
                                                  int num_superpixels,
                                                  const Function& is_wanted) {
  std::vector<std::vector<int>> pixels(static_cast<size_t>(num_superpixels));
  for (size_t i = 0; i < superpixels.NumPixels(); ++i) {
    if (is_wanted(i)) {
      pixels[static_cast<size_t>(superpixels.Data()[i])].push_back(
          static_cast<int>(i));
    }
  }
  return pixels;
}

// Element i of `count` evenly spaced ones among `size`.
size_t Spaced(size_t i, size_t count, size_t size) {
  return (2 * i + 1) * size / (2 * count);
}

// Adds an evenly spaced sample of some pixels' observations, with confidences
// scaled by `share`.
void AddSample(const Image<PixelObservation>& observed,
               const std::vector<int>& pixels,
               size_t count,
               float share,
               ViewEvidence* evidence) {
  for (size_t i = 0; i < count; ++i) {
    PixelObservation pixel =
        observed.Data()[pixels[Spaced(i, count, pixels.size())]];
    pixel.observation.confidence *= share;
    evidence->observations.push_back(pixel.observation);
    evidence->sources.push_back(pixel.source);
    evidence->errors.push_back(pixel.error);
  }
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
                     const EvidenceOptions& options,
                     ViewEvidence* evidence) {
  const Image<PixelObservation> observed =
      ObservePixels(inputs, regions, options, &evidence->confident_depth);
  const auto pixels_of = [&](bool is_prior) {
    return PixelsOfSuperpixels(
        inputs.superpixels, inputs.num_superpixels, [&](size_t i) {
          const PixelObservation& pixel = observed.Data()[i];
          return pixel.observation.confidence > 0.f &&
                 (pixel.source == ObservationSource::kPrior) == is_prior;
        });
  };
  const std::vector<std::vector<int>> own = pixels_of(false);
  const std::vector<std::vector<int>> of_prior =
      inputs.prior.Empty() ? std::vector<std::vector<int>>(own.size())
                           : pixels_of(true);
  evidence->first_observation.push_back(0);
  for (size_t k = 0; k < own.size(); ++k) {
    const float own_weight = SumOfConfidences(observed, own[k]);
    const float prior_weight = SumOfConfidences(observed, of_prior[k]);
    evidence->weights.push_back(own_weight + prior_weight);
    const size_t first = evidence->observations.size();
    AddSample(
        observed,
        own[k],
        std::min(own[k].size(),
                 static_cast<size_t>(options.max_observations_per_superpixel)),
        1.f,
        evidence);
    float sampled = 0.f;
    for (size_t i = first; i < evidence->observations.size(); ++i) {
      sampled += evidence->observations[i].confidence;
    }
    const size_t count =
        std::min(of_prior[k].size(),
                 static_cast<size_t>(options.max_priors_per_superpixel));
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

void AddConfirmed(const EvidenceInputs& inputs,
                  const EvidenceOptions& options,
                  ViewEvidence* evidence) {
  const Image<RayDepth>& confirmed = inputs.confirmed_samples;
  const std::vector<std::vector<int>> only_confirmed = PixelsOfSuperpixels(
      inputs.superpixels, inputs.num_superpixels, [&](size_t i) {
        return !confirmed.Empty() && IsMeasured(confirmed.Data()[i]) &&
               !IsMeasured(inputs.samples.Data()[i]);
      });
  evidence->first_confirmed.push_back(0);
  for (const std::vector<int>& pixels : only_confirmed) {
    const size_t count =
        std::min(pixels.size(),
                 static_cast<size_t>(options.max_confirmed_per_superpixel));
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

void AddBorders(const EvidenceInputs& inputs,
                const EvidenceOptions& options,
                ViewEvidence* evidence) {
  const Image<int>& labels = inputs.superpixels;
  std::vector<std::map<int, BorderPixels>> borders(
      static_cast<size_t>(inputs.num_superpixels));
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
    BorderPixels& border = borders[static_cast<size_t>(first)][second];
    border.weight +=
        options.border_base +
        options.border_contrast * std::exp(-edge / options.border_scale);
    border.pixels.push_back(static_cast<int>(pixel));
  };
  for (int y = 0; y < labels.Height(); ++y) {
    for (int x = 0; x < labels.Width(); ++x) {
      const size_t pixel = labels.View().Index(x, y);
      if (x + 1 < labels.Width()) {
        add(pixel, pixel + 1);
      }
      if (y + 1 < labels.Height()) {
        add(pixel, pixel + static_cast<size_t>(labels.Width()));
      }
    }
  }
  for (size_t first = 0; first < borders.size(); ++first) {
    for (const auto& [second, border] : borders[first]) {
      SuperpixelBorder entry;
      entry.first = static_cast<int>(first);
      entry.second = second;
      entry.weight = border.weight;
      for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
        entry.pixels[i] = border.pixels[Spaced(static_cast<size_t>(i),
                                               SuperpixelBorder::kNumPixels,
                                               border.pixels.size())];
      }
      evidence->borders.push_back(entry);
    }
  }
}

}  // namespace

float MeasureNoise(const EvidenceInputs& inputs) {
  std::vector<float> residuals;
  for (size_t i = 0; i < inputs.samples.NumPixels(); ++i) {
    const RayDepth& sample = inputs.samples.Data()[i];
    const Plane& plane = inputs.superpixel_planes[static_cast<size_t>(
        inputs.superpixels.Data()[i])];
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
  const EvidenceOptions options;
  for (size_t i = 0; i < samples.NumPixels(); ++i) {
    if (!(texture.Data()[i] > options.min_texture) ||
        (!fattening_weight.Empty() &&
         fattening_weight.Data()[i] < kMinOwnTexture)) {
      samples.Data()[i] = {};
    }
  }
  return samples;
}

GatheredEvidence GatherEvidence(const EvidenceInputs& inputs,
                                const EvidenceOptions& options) {
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
  AddObservations(inputs, regions, options, &evidence);
  AddConfirmed(inputs, options, &evidence);
  AddBorders(inputs, options, &evidence);
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

}  // namespace tsar
