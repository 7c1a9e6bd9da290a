// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/macros.h"

namespace tsar {

// The sums of a weighted mean, reduced over a team.
struct WeightedSum {
  double value = 0.0;
  double weight = 0.0;

  TSAR_HD WeightedSum& operator+=(const WeightedSum& other) {
    value += other.value;
    weight += other.weight;
    return *this;
  }
  // weight must not be 0.
  TSAR_HD double Mean() const { return value / weight; }
};

}  // namespace tsar
