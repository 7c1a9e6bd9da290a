// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/refined_maps.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST(ConfidenceLevel, IsZeroForNoDepthAlone) {
  EXPECT_EQ(ToConfidenceLevel(0.f), 0);
  EXPECT_EQ(ToConfidenceLevel(1e-6f), 1);
  EXPECT_EQ(ToConfidenceLevel(0.01f), 3);
  EXPECT_EQ(ToConfidenceLevel(1.f), 255);
  EXPECT_EQ(ToConfidenceLevel(1.1f), 255);
}

TEST(ConfidenceLevel, IsTheNearest) {
  for (int level = 1; level <= 255; ++level) {
    const auto bits = static_cast<uint8_t>(level);
    const float confidence = ConfidenceOfLevel(bits);
    EXPECT_EQ(ToConfidenceLevel(confidence), level);
    EXPECT_EQ(ToConfidenceLevel(confidence - 0.45f / 255.f), level);
    EXPECT_EQ(ToConfidenceLevel(confidence + 0.45f / 255.f), level);
  }
}

}  // namespace
}  // namespace tsar
