// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

namespace tsar {

// The offset to add to the logarithm of a prior's depth, and the standard
// deviation of the remaining error.
struct PriorCorrection {
  Image<float> offset;
  Image<float> sigma;
};

// The errors of a prior are shared by neighboring pixels of one surface: whole
// objects too near, a warp of the image. The correction is a Gaussian Markov
// random field on a coarse grid: a random walk from cell to cell, with large
// steps where the prior's depth jumps, observed where depths were measured
// (ordinary kriging). The variances of steps, within surfaces and across jumps,
// and of the measurements of cells are estimated in the image itself.
// Measurements that contradict the field get Cauchy weights.
//
// log_depth: the prior's; NaN: none. residual: log of the measured depth minus
// log_depth; NaN where there is none. offset and sigma are NaN where log_depth
// is. The bits of the result depend on the arguments alone.
PriorCorrection CorrectPrior(const Image<float>& log_depth,
                             const Image<float>& residual);

}  // namespace tsar
