// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tsar {

// A number in a byte: the labels of all views of a scene are in memory at once.
template <int kMin, int kMax>
class ByteOf {
 public:
  static_assert(kMin <= 0 && kMax > kMin);

  ByteOf() : ByteOf(0.f) {}
  // What lies outside the range is clamped.
  explicit ByteOf(float value)
      : level_(static_cast<uint8_t>(std::lround(
            (std::clamp(value, float{kMin}, float{kMax}) - kMin) * kScale))) {}

  float Value() const { return level_ / kScale + kMin; }

 private:
  static constexpr float kScale = 255.f / (kMax - kMin);
  uint8_t level_;
};

// How well the plane that a superpixel was labelled with is borne out there.
struct LabelQuality {
  ByteOf<0, 1> explained;    // See PlaneCost.
  ByteOf<0, 1> strength;     // See PlaneCost.
  ByteOf<0, 1> confirmed;    // See PlaneCost.
  ByteOf<0, 1> uncertainty;  // See PlaneCost.
  // How much more the next best plane, or none, would cost in each pixel,
  // neighbours left aside; negative where the neighbours decided.
  ByteOf<-1, 2> margin;
};

}  // namespace tsar
