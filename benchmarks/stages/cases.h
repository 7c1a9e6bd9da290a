// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <string>
#include <vector>

#include "benchmarks/stages/stage_inputs.h"

namespace tsar {

// One thing to measure. In the comments at the cases, P is the number of the
// maps' pixels, R that of the raster of superpixels and regions, S the number
// of sources.
struct StageCase {
  std::string name;
  // What one run works on: pixels, or samples of a texture.
  double num_items = 0.0;
  // What one run must read and write at least, each input and output once, if
  // caches held everything else.
  double num_bytes = 0.0;
  std::function<void()> run;
  // If the run changes its input: recreates it, outside the measured time.
  std::function<void()> prepare = [] {};
};

// The cases hold references to the inputs.
std::vector<StageCase> TransferCases(const StageInputs& inputs);
std::vector<StageCase> MatchingCases(const StageInputs& inputs);
std::vector<StageCase> RefinementCases(const StageInputs& inputs);
std::vector<StageCase> SegmentationCases(const StageInputs& inputs);
std::vector<StageCase> CompositionCases(const StageInputs& inputs);

}  // namespace tsar
