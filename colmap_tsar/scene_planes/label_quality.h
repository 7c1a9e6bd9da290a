// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tsar {

// A number from kMin to kMax in 255 equal steps: the labels of all views of a
// scene are in memory at once.
template <int kMin, int kMax>
class ByteOf {
 public:
  static_assert(kMin <= 0 && kMax > kMin);

  ByteOf() : ByteOf(0.f) {}
  // Rounds, and clamps what lies outside.
  explicit ByteOf(float value)
      : level_(static_cast<uint8_t>(std::lround(
            (std::clamp(value, float{kMin}, float{kMax}) - kMin) * kScale))) {}

  float Value() const { return level_ / kScale + kMin; }

  friend bool operator==(const ByteOf&, const ByteOf&) = default;

 private:
  static constexpr float kScale = 255.f / (kMax - kMin);
  uint8_t level_;
};

// How well the plane that a superpixel was labelled with is borne out there.
struct LabelQuality {
  // What PlaneCost says of the superpixel on this plane.
  ByteOf<0, 1> explained;
  ByteOf<0, 1> strength;
  ByteOf<0, 1> confirmed;
  ByteOf<0, 1> uncertainty;
  // How much more the next best plane, or none, would cost, neighbours left
  // aside, in pixels of full confidence for each pixel of the superpixel;
  // negative where the neighbours decided.
  ByteOf<-1, 2> margin;

  friend bool operator==(const LabelQuality&, const LabelQuality&) = default;
};

}  // namespace tsar
