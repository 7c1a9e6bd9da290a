// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene_planes/observed_source.h"

#include <cmath>
#include <cstdint>

// Votes of the other views on a surface of the reference: a view that measured
// the same depth there confirms it.
namespace tsar {

// More views than these change nothing.
constexpr int kMaxVotes = 2;

// Whether the source confirms a point in the reference camera's frame. max_gap:
// between the point and what the source measured, in relative depths of one
// pixel of disparity.
TSAR_HD inline bool Confirms(const ObservedSource& source,
                             const Vec3f& point,
                             float max_gap) {
  SeenPoint seen;
  if (!FindInSource(source, point, &seen)) {
    return false;
  }
  const float measured = source.confident_depth(seen.column, seen.row);
  return measured > 0.f &&
         fabsf(seen.depth - measured) /
                 (measured * source.resolution.RelativeDepthError(measured)) <
             max_gap;
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

// The votes on one superpixel. No pixel counts for more than kMaxVotes.
struct SuperpixelVotes {
  int num_confirmed = 0;
  int num_tests = 0;
  int num_impossible = 0;  // Tests where the surface has no depth.
};

// Adds the votes of several views on one point.
TSAR_HD inline void AddVotes(const ObservedSource* sources,
                             int num_sources,
                             const Vec3f& point,
                             float max_gap,
                             SuperpixelVotes* sum) {
  int num_confirmed = 0;
  for (int j = 0; j < num_sources && num_confirmed < kMaxVotes; ++j) {
    num_confirmed += Confirms(sources[j], point, max_gap) ? 1 : 0;
  }
  sum->num_confirmed += num_confirmed;
}

}  // namespace tsar
