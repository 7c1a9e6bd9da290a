// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/report/label_colors.h"

#include "colmap_tsar/base/label_color.h"

#include <algorithm>

namespace tsar {
namespace {

constexpr Rgb kBorder = {255, 214, 0};

}  // namespace

Image<Rgb> ColorizeLabels(const Image<int>& labels) {
  Image<Rgb> colors(labels.Width(), labels.Height());
  std::transform(labels.begin(), labels.end(), colors.begin(), LabelColor);
  return colors;
}

Image<Rgb> DrawLabelBorders(const Image<int>& labels, Image<Rgb> image) {
  for (int y = 0; y < labels.Height(); ++y) {
    for (int x = 0; x < labels.Width(); ++x) {
      const int label = labels(x, y);
      if ((x > 0 && labels(x - 1, y) != label) ||
          (y > 0 && labels(x, y - 1) != label)) {
        image(x, y) = kBorder;
      }
    }
  }
  return image;
}

}  // namespace tsar
