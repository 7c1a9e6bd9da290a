// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/evaluation/tolerances.h"

#include <limits>

#include "tests/evaluation/test_files.h"

namespace tsar {
namespace {

TEST(Tolerances, AreReadFromAList) {
  EXPECT_EQ(ParseTolerances("0.02"), std::vector<double>{0.02});
  EXPECT_EQ(ParseTolerances("1e-3,0.5,2"),
            (std::vector<double>{0.001, 0.5, 2}));
}

TEST(Tolerances, ListsThatAreNoneAreErrors) {
  for (const char* text : {"",
                           ",",
                           "0.1,",
                           ",0.1",
                           "0.1 0.2",
                           "0.1;0.2",
                           "x",
                           "0.2,0.1",
                           "0.1,0.1",
                           "0",
                           "-1",
                           "nan",
                           "inf"}) {
    EXPECT_EQ(CodeOf([&] { ParseTolerances(text); }), ErrorCode::kBadOption)
        << text;
  }
  EXPECT_EQ(CodeOf([] { CheckTolerances({}); }), ErrorCode::kBadOption);
}

TEST(HarmonicMean, IsNearTheSmallerAndZeroWithoutAny) {
  EXPECT_DOUBLE_EQ(HarmonicMean(0.5, 0.5), 0.5);
  EXPECT_DOUBLE_EQ(HarmonicMean(1, 0.25), 0.4);
  EXPECT_EQ(HarmonicMean(1, 0), 0);
  EXPECT_EQ(HarmonicMean(0, 0), 0);
}

}  // namespace
}  // namespace tsar
