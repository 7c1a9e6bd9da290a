// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/superpixel_matches.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/median.h"
#include "colmap_tsar/scene/evidence/render_source_depth.h"

#include <cmath>
#include <cstdint>
#include <optional>

namespace tsar {
namespace {

// The median depth of each superpixel's observations; 0 where there are none.
std::vector<float> MedianDepths(const ViewEvidence& evidence) {
  std::vector<float> medians;
  std::vector<float> depths;
  for (int k = 0; k < evidence.NumSuperpixels(); ++k) {
    depths.clear();
    for (int i = evidence.first_observation[k];
         i < evidence.first_observation[k + 1];
         ++i) {
      depths.push_back(evidence.observations[i].sample.z);
    }
    medians.push_back(depths.empty() ? 0.f : UpperMedian(&depths));
  }
  return medians;
}

// The superpixel of a view that a point in its camera's frame projects into.
std::optional<int> SuperpixelAt(const ObservedView& view, const Vec3f& point) {
  if (!(point.z > 0.f)) {
    return std::nullopt;
  }
  float x = 0.f;
  float y = 0.f;
  view.camera.GetIntrinsics().Project(point, &x, &y);
  x = std::round(x);
  y = std::round(y);
  const Image<uint16_t>& superpixels = view.evidence->superpixels;
  if (!(x >= 0.f && y >= 0.f && x < superpixels.Width() &&
        y < superpixels.Height())) {
    return std::nullopt;
  }
  return superpixels(static_cast<int>(x), static_cast<int>(y));
}

}  // namespace

SuperpixelMatches::SuperpixelMatches(const std::vector<ObservedView>& views) {
  std::vector<std::vector<float>> depths;
  std::vector<int> first_of_view = {0};
  for (const ObservedView& view : views) {
    depths.push_back(MedianDepths(*view.evidence));
    first_of_view.push_back(first_of_view.back() +
                            view.evidence->NumSuperpixels());
  }
  const size_t num_views = views.size();
  std::vector<RelativePose> poses(num_views);
  for (size_t i = 0; i < num_views; ++i) {
    const ViewEvidence& evidence = *views[i].evidence;
    for (size_t j = 0; j < num_views; ++j) {
      poses[j] = ComputeRelativePose(views[i].camera, views[j].camera);
    }
    for (int k = 0; k < evidence.NumSuperpixels(); ++k) {
      const size_t begin = evidence.first_observation[k];
      const size_t count = evidence.first_observation[k + 1] - begin;
      for (size_t j = 0; j < num_views && count > 0; ++j) {
        if (j == i) {
          continue;
        }
        // Each view gets a different observation, spaced over the superpixel.
        const RayDepth& sample =
            evidence.observations[begin + (2 * j + 1) * count / (2 * num_views)]
                .sample;
        const Vec3f point =
            poses[j] * (Vec3f{sample.x, sample.y, 1.f} * sample.z);
        const std::optional<int> there = SuperpixelAt(views[j], point);
        if (there &&
            std::abs(depths[j][*there] - point.z) < kOtherSurface * point.z) {
          matches_.push_back(first_of_view[j] + *there);
        }
      }
      first_.push_back(matches_.size());
    }
  }
}

}  // namespace tsar
