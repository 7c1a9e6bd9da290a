// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene_planes/observed_source.h"

#include <cmath>
#include <cstdint>

// Votes of the other views on a surface of the reference: a view that measured
// the same depth there confirms it, and one that saw through it, to a depth
// that is as good as certain, contradicts it.
namespace tsar {

// Gaps between a surface and what another view measured, in relative depths of
// one pixel of disparity.
struct VoteLimits {
  float max_confirmed = 0.f;     // Below this on either side.
  float min_contradicted = 0.f;  // The surface more than this in front.
};

// More views than these that say the same about a pixel change nothing.
constexpr int kMaxVotes = 2;

struct Votes {
  int confirmed = 0;
  int contradicted = 0;
};

// Adds the view's vote on a point in the reference camera's frame.
TSAR_HD inline void AddVote(const ObservedSource& source,
                            const Vec3f& point,
                            const VoteLimits& limits,
                            Votes* votes) {
  SeenPoint seen;
  if (!FindInSource(source, point, &seen)) {
    return;
  }
  const float measured = source.confident_depth(seen.column, seen.row);
  if (!(measured > 0.f)) {
    return;
  }
  const float gap = (seen.depth - measured) /
                    (measured * source.resolution.RelativeDepthError(measured));
  if (fabsf(gap) < limits.max_confirmed) {
    ++votes->confirmed;
  } else if (gap < -limits.min_contradicted) {
    ++votes->contradicted;
  }
}

// Which of a superpixel's pixels are asked about: evenly spaced ones.
struct VoteSampling {
  int pixels_per_test = 1;
  // A small superpixel has so many tests, or one at each of its pixels.
  int min_tests = 1;

  TSAR_HD int NumTests(int num_pixels) const {
    const int few = num_pixels < min_tests ? num_pixels : min_tests;
    const int many = num_pixels / pixels_per_test;
    const int num_tests = many > few ? many : few;
    return num_tests > 1 ? num_tests : 1;
  }

  // The number of the pixel of a test.
  TSAR_HD static int Pixel(int test, int num_tests, int num_pixels) {
    return static_cast<int>((2 * test + 1) * static_cast<int64_t>(num_pixels) /
                            (2 * num_tests));
  }
};

// Planes are compared for all superpixels at once, on the device.
inline constexpr VoteSampling kPlaneSampling{9, 1};
// A growing surface is tested on the host, again in each round: fewer pixels.
// It bends, so that one pixel does not tell of all of a small superpixel.
inline constexpr VoteSampling kCurvedSampling{64, 6};

// The votes on one superpixel. No pixel counts for more than kMaxVotes of a
// kind.
struct SuperpixelVotes {
  Votes votes;
  int num_tests = 0;
  int num_impossible = 0;  // Tests where the surface has no depth.
};

// Adds the votes of several views on one point.
TSAR_HD inline void AddVotes(const ObservedSource* sources,
                             int num_sources,
                             const Vec3f& point,
                             const VoteLimits& limits,
                             SuperpixelVotes* sum) {
  Votes votes;
  for (int j = 0; j < num_sources; ++j) {
    AddVote(sources[j], point, limits, &votes);
  }
  sum->votes.confirmed +=
      votes.confirmed < kMaxVotes ? votes.confirmed : kMaxVotes;
  sum->votes.contradicted +=
      votes.contradicted < kMaxVotes ? votes.contradicted : kMaxVotes;
}

// bool point_at(int number, Vec3f* point): the surface's point at one of the
// superpixel's pixels, false where it has none.
template <typename PointAt>
TSAR_HD SuperpixelVotes CollectVotes(int num_pixels,
                                     const VoteSampling& sampling,
                                     const ObservedSource* sources,
                                     int num_sources,
                                     const VoteLimits& limits,
                                     const PointAt& point_at) {
  SuperpixelVotes sum;
  sum.num_tests = sampling.NumTests(num_pixels);
  for (int i = 0; i < sum.num_tests && num_pixels > 0; ++i) {
    Vec3f point;
    if (!point_at(VoteSampling::Pixel(i, sum.num_tests, num_pixels), &point)) {
      ++sum.num_impossible;
      continue;
    }
    AddVotes(sources, num_sources, point, limits, &sum);
  }
  return sum;
}

}  // namespace tsar
