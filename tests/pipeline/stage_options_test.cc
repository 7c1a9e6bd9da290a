// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/stage_options.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(StageOptions, KeyRandomNumbersByImageAndSeed) {
  RefineOptions options;
  options.seed = 7;
  const GroupPlaneOptions superpixels =
      MakeCorrelationOptions(options, 3).planes.ransac;
  const GroupPlaneOptions regions =
      MakeRegionPlaneOptions(options, 1.0, 3).ransac;
  for (const GroupPlaneOptions& ransac : {superpixels, regions}) {
    EXPECT_EQ(ransac.image_id, 3u);
    EXPECT_EQ(ransac.seed, 7u);
  }
}

}  // namespace
}  // namespace tsar
