// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/cuda/stage_result.h"

#include <cmath>

#include <gtest/gtest.h>

namespace tsar {
namespace {

std::string DifferencesBetween(const std::vector<Vec3f>& a,
                               const std::vector<Vec3f>& b) {
  StageResult first;
  first.Add("normal", a);
  StageResult second;
  second.Add("normal", b);
  return FindDifferences(first, second);
}

TEST(StageResult, IsTheSameToTheLastBit) {
  const float next = std::nextafter(0.7f, 1.f);
  const std::vector<Vec3f> values = {{1.f, 2.f, 3.f}, {0.7f, 0.f, NAN}};
  EXPECT_EQ(DifferencesBetween(values, values), "");
  EXPECT_EQ(DifferencesBetween(values, {{1.f, 2.f, 3.f}, {next, -0.f, NAN}}),
            "normal: 1 of 2 elements differ; the first is number 1: "
            "0.699999988 and 0.700000048\n");
  EXPECT_EQ(
      DifferencesBetween(values, {{1.f, 2.f, 3.f}, {0.7f, -0.f, NAN}}),
      "normal: 1 of 2 elements differ; the first is number 1: 0 and -0\n");
  EXPECT_NE(DifferencesBetween(values, {{1.f, 2.f, 3.f}, {0.7f, 0.f, 0.f}}),
            "");
}

TEST(StageResult, HasAsManyChannelsAndNumbers) {
  EXPECT_EQ(DifferencesBetween({{}, {}}, {{}}), "normal: 6 and 3 numbers\n");
  StageResult empty;
  StageResult one;
  one.Add("count", std::vector<int>{1});
  EXPECT_EQ(FindDifferences(empty, one), "the numbers of channels differ");
}

}  // namespace
}  // namespace tsar
