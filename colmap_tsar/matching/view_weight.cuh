// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/base/macros.h"

namespace tsar {

// The weight of a source view at a pixel: joint view selection by the costs of
// the pixel's candidate planes in that view (Xu and Tao, CVPR 2019, section
// 3.3). A view that sees the surface has some low costs and few high ones.
class ViewWeight {
 public:
  // iteration counts from 0; the threshold of low costs decreases with it.
  TSAR_HD explicit ViewWeight(int iteration)
      : low_cost_(
            0.8f *
            ExpOfNegative(-static_cast<float>(iteration * iteration) / 90.f)) {}

  // Adds a cost of this view, in [0, 2].
  TSAR_HD void Add(float cost) {
    if (cost < low_cost_) {
      ++num_low_;
      sum_ += ExpOfNegative(-cost * cost / (2.f * 0.3f * 0.3f));
    } else if (cost > 1.2f) {
      ++num_high_;
    }
  }

  // The weight in [0, 255], stored for each pixel and view; 0: not selected.
  TSAR_HD int Get() const {
    return num_low_ > 2 && num_high_ < 3
               ? static_cast<int>(255.f * sum_ / num_low_ + 0.5f)
               : 0;
  }

 private:
  float low_cost_;
  float sum_ = 0.f;
  int num_low_ = 0;
  int num_high_ = 0;
};

}  // namespace tsar
