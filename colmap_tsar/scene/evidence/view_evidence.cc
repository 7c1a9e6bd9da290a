// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <algorithm>
#include <utility>

namespace tsar {

int ViewEvidence::FirstOfPrior(int superpixel) const {
  int first = first_observation[superpixel + 1];
  while (first > first_observation[superpixel] && IsOfPrior(first - 1)) {
    --first;
  }
  return first;
}

void RemovePrior(ViewEvidence* evidence) {
  const std::vector<Observation> observations =
      std::exchange(evidence->observations, {});
  const std::vector<ObservationSource> sources =
      std::exchange(evidence->sources, {});
  evidence->errors.clear();
  size_t end = 0;
  for (size_t k = 0; k < evidence->weights.size(); ++k) {
    const size_t begin = end;
    end = evidence->first_observation[k + 1];
    float own = 0.f;
    float all = 0.f;
    for (size_t i = begin; i < end; ++i) {
      all += observations[i].confidence;
      if (sources[i] != ObservationSource::kPrior) {
        own += observations[i].confidence;
        evidence->observations.push_back(observations[i]);
        evidence->sources.push_back(sources[i]);
      }
    }
    if (own < all) {
      evidence->weights[k] *= own / all;
    }
    evidence->first_observation[k + 1] =
        static_cast<int>(evidence->observations.size());
  }
  PriorAssessment& assessment = evidence->prior.assessment;
  for (PriorVerdict* verdict : {&assessment.verdict, &assessment.of_normals}) {
    if (*verdict == PriorVerdict::kUsed) {
      *verdict = PriorVerdict::kOthersUnlike;
    }
  }
  AlignedPrior without_values;
  without_values.assessment = assessment;
  evidence->prior = without_values;
}

std::vector<float> CountPixels(const ViewEvidence& evidence) {
  std::vector<float> num_pixels(evidence.weights.size(), 0.f);
  for (const uint16_t superpixel : evidence.superpixels) {
    ++num_pixels[superpixel];
  }
  return num_pixels;
}

std::vector<Vec3f> MiddleRays(const ViewEvidence& evidence,
                              const Intrinsics& intrinsics) {
  struct PixelSum {
    int64_t x = 0;
    int64_t y = 0;
    int count = 0;
  };
  std::vector<PixelSum> sums(evidence.weights.size());
  for (int y = 0; y < evidence.height; ++y) {
    for (int x = 0; x < evidence.width; ++x) {
      PixelSum& sum = sums[evidence.superpixels(x, y)];
      sum.x += x;
      sum.y += y;
      ++sum.count;
    }
  }
  std::vector<Vec3f> rays;
  for (const PixelSum& sum : sums) {
    const double count = std::max(sum.count, 1);
    rays.push_back(intrinsics.Ray(sum.x / count, sum.y / count));
  }
  return rays;
}

}  // namespace tsar
