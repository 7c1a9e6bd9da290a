// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"

namespace tsar {

// By how much the logarithm of a prior's depth is to be corrected, and the
// standard deviation of what is then left.
struct PriorCorrection {
  Image<float> offset;
  Image<float> sigma;
};

// A prior is right up to errors that neighbouring pixels of one surface share:
// whole objects too near, a warp of the image. The correction is a Gaussian
// Markov random field on a coarse grid: a random walk from cell to cell, whose
// steps are large where the prior's depth jumps, that is observed where depths
// were measured (ordinary kriging). How large steps are, across the image and
// across jumps, and how much measurements of neighbouring cells differ, is
// estimated in the image itself. Measurements that contradict the field count
// by Cauchy's weights.
//
// log_depth: of the prior; NaN: none. residual: log of the measured depth minus
// log_depth; NaN where there is none. Of the result, offset and sigma are NaN
// where log_depth is. The bits depend on the arguments alone.
PriorCorrection CorrectPrior(const Image<float>& log_depth,
                             const Image<float>& residual);

}  // namespace tsar
