// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/io/sparse_model.h"

#include <optional>

namespace tsar {

struct DepthInterval {
  double min = 0.0;
  double max = 0.0;
};

// The depth range of an image, as COLMAP estimates it: from the 1st to the 99th
// percentile of the sparse points in front of it, widened by a quarter. Nothing
// where the image has none.
std::optional<DepthInterval> SparseDepthInterval(const SparseModel& model,
                                                 int image);

}  // namespace tsar
