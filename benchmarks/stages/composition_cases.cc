// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include <memory>
#include <utility>

#include "benchmarks/stages/cases.h"

namespace tsar {
std::vector<StageCase> CompositionCases(const StageInputs& in) {
  const double pixels = in.NumPixels();
  const double rounds = in.options.num_iterations;
  const auto own = std::make_shared<DepthNormalImages>();
  const auto composed = std::make_shared<ComposedMap>();
  return {
      // Bytes: a map of depth and normal and a mask; a map and its provenance.
      {"ComposeMap",
       pixels,
       (16.0 + 1.0 + 17.0) * pixels,
       [&in, own] { in.Compose(std::move(*own)); },
       [&in, own] { *own = in.OwnMap(); }},
      // R2. Items: P per round, of which few are holes. Bytes: each round looks
      // for holes in the depth; what it fills depends on the scene.
      {"InterpolateHoles",
       rounds * pixels,
       rounds * 4.0 * pixels,
       [&in, composed] {
         WeightedMedianOptions filter =
             in.MedianOptions(2.0 * in.options.window_radius);
         filter.min_support = 1.f / 3.f;
         InterpolateHoles(in.views.Color(),
                          in.views.MapIntrinsics(),
                          in.options.num_iterations,
                          filter,
                          &composed->map,
                          in.device);
       },
       [&in, composed] { *composed = in.Compose(in.OwnMap()); }},
  };
}

}  // namespace tsar
