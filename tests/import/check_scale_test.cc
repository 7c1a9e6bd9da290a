// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/check_scale.h"

#include <gtest/gtest.h>

namespace tsar {
namespace {

// One camera at the origin; points at depths 1, 2, ..., num_points.
SparseModel MakeModel(int num_points) {
  SparseModel model;
  SparseModel::ModelImage image;
  image.name = "a.png";
  image.camera.width = 100;
  image.camera.height = 80;
  image.camera.fx = 50.0;
  image.camera.fy = 50.0;
  image.camera.cx = 50.0;
  image.camera.cy = 40.0;
  for (int i = 0; i < num_points; ++i) {
    const double z = i + 1.0;
    model.points.emplace_back(0.08 * (i - 5) * z, 0.0, z);
    image.point_indices.push_back(i);
  }
  model.images.push_back(image);
  model.IndexNames();
  return model;
}

TEST(CompareWithSparse, TakesTheMedianRatio) {
  const SparseModel model = MakeModel(11);
  // Point i is seen in column 50 + 4 (i - 5); depth of half the size.
  Image<float> depth(50, 40);
  for (int i = 0; i < 11; ++i) {
    const float wrong = i == 3 ? 100.f : 1.f;
    const int x = 25 + 2 * (i - 5);
    depth(x, 20) = 3.f * static_cast<float>(i + 1) * wrong;
  }
  depth(0, 0) = 7.f;
  const SparseComparison comparison = CompareWithSparse(model, 0, depth);
  EXPECT_EQ(comparison.num_points, 11);
  EXPECT_NEAR(comparison.ratio, 3.0, 1e-6);
  EXPECT_EQ(comparison.near, 3.f);
  EXPECT_EQ(comparison.far, 1200.f);
  EXPECT_EQ(comparison.sparse_near, 1.f);
  EXPECT_EQ(comparison.sparse_far, 11.f);
}

TEST(CompareWithSparse, LeavesOutPointsOutsideOrBehindOrWithoutDepth) {
  SparseModel model = MakeModel(4);
  model.points[0] = {0.0, 0.0, -1.0};
  model.points[1] = {100.0, 0.0, 1.0};
  model.points[2] = {0.0, -100.0, 1.0};
  EXPECT_EQ(CompareWithSparse(model, 0, Image<float>(100, 80, 1.f)).num_points,
            1);
  EXPECT_EQ(CompareWithSparse(model, 0, Image<float>(100, 80)).num_points, 0);
}

SparseComparison WithRatio(double ratio, int num_points = 10) {
  SparseComparison comparison;
  comparison.num_points = num_points;
  comparison.ratio = ratio;
  return comparison;
}

TEST(JudgeScale, IsConsistentWhereFourOfFiveAgree) {
  const ScaleVerdict verdict = JudgeScale({WithRatio(2.0),
                                           WithRatio(2.1),
                                           WithRatio(1.9),
                                           WithRatio(2.0),
                                           WithRatio(9.0),
                                           WithRatio(0.1, 4)});
  EXPECT_EQ(verdict.num_images, 5);
  EXPECT_EQ(verdict.median, 2.0);
  EXPECT_EQ(verdict.smallest, 1.9);
  EXPECT_EQ(verdict.largest, 9.0);
  EXPECT_TRUE(verdict.is_consistent);
  EXPECT_FALSE(JudgeScale({WithRatio(1.0), WithRatio(2.0), WithRatio(3.0)})
                   .is_consistent);
  EXPECT_EQ(JudgeScale({}).num_images, 0);
  EXPECT_FALSE(JudgeScale({WithRatio(3.0, 2)}).is_consistent);
}

TEST(IsOffScale, BeginsAtTwentyPercent) {
  for (const double ratio : {1.0, 1.19, 0.84}) {
    EXPECT_FALSE(IsOffScale(ratio)) << ratio;
  }
  for (const double ratio : {1.21, 0.82, 0.0, 1000.0}) {
    EXPECT_TRUE(IsOffScale(ratio)) << ratio;
  }
}

}  // namespace
}  // namespace tsar
