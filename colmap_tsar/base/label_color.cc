// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/label_color.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tsar {
namespace {

// One channel of an HSV color; the hue is in turns.
uint8_t Channel(double hue, double saturation, double brightness) {
  const double distance = std::abs(hue - std::floor(hue) - 0.5) * 6.0;
  const double share = std::clamp(distance - 1.0, 0.0, 1.0);
  return static_cast<uint8_t>(
      std::lround(brightness * (1.0 - saturation * (1.0 - share))));
}

}  // namespace

Rgb LabelColor(int label) {
  if (label < 0) {
    return {};
  }
  // The golden ratio spreads the hues of any first labels evenly.
  const double hue = label * 0.6180339887498949;
  // Labels that differ by 5, 8 or 13 have nearly the same hue and differ in
  // these.
  const double saturation = label % 3 == 0 ? 0.7 : label % 3 == 1 ? 0.45 : 0.85;
  const double brightness = label % 4 < 2 ? 240.0 : 165.0;
  return {Channel(hue, saturation, brightness),
          Channel(hue - 1.0 / 3.0, saturation, brightness),
          Channel(hue - 2.0 / 3.0, saturation, brightness)};
}

}  // namespace tsar
