// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace tsar {

// A value from kMin to kMax in 255 equal steps, in one byte: the labels of all
// views of a scene are in memory at once.
template <int kMin, int kMax>
class ByteOf {
 public:
  static_assert(kMin <= 0 && kMax > kMin);

  ByteOf() : ByteOf(0.f) {}
  // Rounds, and clamps to the range.
  explicit ByteOf(float value)
      : level_(static_cast<uint8_t>(std::lround(
            (std::clamp(value, float{kMin}, float{kMax}) - kMin) * kScale))) {}

  float Value() const { return level_ / kScale + kMin; }

  friend bool operator==(const ByteOf&, const ByteOf&) = default;

 private:
  static constexpr float kScale = 255.f / (kMax - kMin);
  uint8_t level_;
};

// The evidence in a superpixel for the plane that it was labeled with.
struct LabelQuality {
  // The fields of PlaneCost for the superpixel on this plane.
  ByteOf<0, 1> strength;
  ByteOf<0, 1> confirmed;
  ByteOf<0, 1> uncertainty;
  // The unary cost of the second-best plane, or none, less that of the label,
  // in pixels of full confidence for each pixel of the superpixel; negative
  // where the pairwise costs decided.
  ByteOf<-1, 2> margin;

  friend bool operator==(const LabelQuality&, const LabelQuality&) = default;
};

// Costs are in pixels of full confidence. Depth differences are in relative
// depths of one pixel of disparity.
struct LabelOptions {
  // The residual from which an observation counts fully against a plane.
  float tolerance = 1.f;
  // The cost of an observation where the superpixel has no plane. A plane with
  // a higher cost is not chosen, unless the pairwise costs outweigh that.
  float cost_of_unexplained = 0.6f;
  // The weight of a depth that other views confirm and the view did not trust:
  // most are wrong on bare surfaces, but many tell a chest from its wall.
  float confirmed_weight = 0.2f;
  // The share of measured pixels at which ViewLabels::strengths is half of its
  // value with many measurements.
  float strength_prior = 0.02f;
  // Costs per pixel without an observation: of no plane, and of a plane whose
  // depth there is unknown.
  float unlabeled_cost = 0.02f;
  float uncertainty_cost = 0.05f;
  // The expected error of a plane at which its depth counts as unknown.
  float max_sigma = 1.f;
  // The uncertainty of a plane's depth where it was observed on one side only,
  // far away.
  float extrapolation_uncertainty = 0.6f;
  // That distance, relative to the size of the area in which the plane was
  // observed.
  float extrapolation_reach = 0.6f;
  // The cost of a pixel without an observation whose region has different
  // colors in other views: per full difference beyond that on the best plane
  // plus min_color_gap, which allows for noise and gloss. Planes above
  // max_color_uncertainty are not compared with: an unobserved one may fit by
  // chance.
  float color_cost = 4.f;
  float min_color_gap = 0.05f;
  float max_color_uncertainty = 0.3f;
  // The cost of a pixel without an observation on a plane whose normal a prior
  // contradicts: by four of its standard deviations; up to two cost nothing,
  // since superpixels of one surface share their errors.
  float normal_cost = 0.3f;
  // The largest residual of depths of other views at which they confirm a
  // plane, as a share of the tolerance.
  float confirmation_share = 0.5f;
  // A border between two planes is free where they intersect in the image, and
  // costs its full weight from this distance from the intersection on, in
  // pixels of the raster: half the width of a superpixel, which crosses the
  // true border by as much.
  float crease_reach = 10.f;
};

// What a label is based on.
enum class LabelOrigin : uint8_t {
  kNone = 0,      // There is no plane.
  kGuessed = 1,   // Only the neighbors in the image support it.
  kCarried = 2,   // Other views measured the plane there.
  kMeasured = 3,  // The superpixel's own observations support it.
};

// The label of each superpixel of a view.
struct ViewLabels {
  std::vector<int> planes;  // Indices of planes; -1: none.
  std::vector<LabelOrigin> origins;
  // All 0 where there is no plane.
  std::vector<LabelQuality> qualities;
  // How strongly the superpixel's measurements support its plane, from 0 to 1
  // (PlaneCost::strength): the weight of its vote in other views. Empty once
  // the scene is modeled.
  std::vector<float> strengths = {};
};

}  // namespace tsar
