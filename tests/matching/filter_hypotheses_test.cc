// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/filter_hypotheses.h"

#include <limits>

#include "tests/matching/textured_plane.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

// At each scale, a plane three units away.
class FilterHypothesesTest : public testing::TestWithParam<float> {
 protected:
  FilterHypothesesTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 100.0)),
        scene_(DrawnPlane({0.3f, -0.2f, -1.f}, 3.f), camera_, *device_) {}

  // Half a unit is an angle of 9 degrees.
  void AddSource(double x, double y) {
    scene_.AddSource(SourceCamera(camera_, {x, y, 0.0}, -0.3 * x));
  }
  void AddThreeSources() {
    AddSource(0.5, 0.05);
    AddSource(-0.5, 0.05);
    AddSource(0.3, 0.4);
  }
  void ScaleDepth(float factor) {
    for (float& depth : scene_.Depth()) {
      depth *= factor;
    }
  }

  // The scene in units of 1 / GetParam(), with what the filter leaves of it in
  // units of 1.
  Image<float> Filter() {
    const float scale = GetParam();
    std::vector<SourceView> sources = scene_.HostSources();
    DeviceCopies on_device(*device_);
    for (size_t i = 0; i < sources.size(); ++i) {
      sources[i].from_reference.translation =
          sources[i].from_reference.translation * scale;
      Image<float> scaled = scene_.SourceDepth(static_cast<int>(i));
      for (float& value : scaled) {
        value *= scale;
      }
      sources[i].depth = on_device(scaled);
    }
    Image<float> depth = scene_.Depth();
    for (float& value : depth) {
      value *= scale;
    }
    ReferenceView reference = scene_.Reference();
    reference.depth = on_device(depth);
    if (!normal_.Empty()) {
      reference.normal = on_device(normal_);
    }
    Image<float> filtered =
        FilterHypotheses(
            reference, SourceViews(*device_, sources), options_, *device_)
            .ToHost();
    for (size_t i = 0; i < filtered.NumPixels(); ++i) {
      // Kept depths do not change.
      if (filtered.Data()[i] != 0.f) {
        EXPECT_EQ(filtered.Data()[i], depth.Data()[i]);
      }
    }
    return filtered;
  }
  // The share that is kept of the pixels in the middle, which all sources see.
  float ShareKept() {
    const Image<float> filtered = Filter();
    int num_kept = 0;
    int num_all = 0;
    ForEachPixel(22, 42, 16, 32, [&](int x, int y) {
      num_kept += filtered(x, y) > 0.f ? 1 : 0;
      ++num_all;
    });
    return static_cast<float>(num_kept) / num_all;
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  TexturedPlane scene_;
  Image<Vec3f> normal_;  // Instead of the truth.
  HypothesisFilterOptions options_;
};

TEST_P(FilterHypothesesTest, RemovesOnlyWrongDepths) {
  AddThreeSources();
  scene_.Depth()(30, 20) *= 0.9f;
  const Image<float> filtered = Filter();
  EXPECT_EQ(filtered(30, 20), 0.f);
  EXPECT_GT(filtered(31, 20), 0.f);
  EXPECT_GT(filtered(30, 21), 0.f);
}

TEST_P(FilterHypothesesTest, NeedsEnoughConsistentSources) {
  AddThreeSources();
  options_.min_num_consistent = 3;
  EXPECT_EQ(ShareKept(), 1.f);
  options_.min_num_consistent = 4;
  EXPECT_EQ(ShareKept(), 0.f);
  // One that looks away does not count as a fourth.
  scene_.AddSource(SourceCamera(camera_, {0.5, 0.0, 0.0}, 3.14159265));
  EXPECT_EQ(ShareKept(), 0.f);
}

TEST_P(FilterHypothesesTest, NeedsTheDepthsOfTheSources) {
  AddThreeSources();
  for (float& depth : scene_.SourceDepth(0)) {
    depth *= 1.15f;
  }
  EXPECT_EQ(ShareKept(), 1.f);
  scene_.SourceDepth(1) = Image<float>(kWidth, kHeight, 0.f);
  EXPECT_EQ(ShareKept(), 0.f);
  options_.min_num_consistent = 1;
  EXPECT_EQ(ShareKept(), 1.f);
  scene_.SourceDepth(2) = Image<float>();
  EXPECT_EQ(ShareKept(), 0.f);
}

TEST_P(FilterHypothesesTest, LimitsTheReprojectionError) {
  AddThreeSources();
  options_.geom_consistency_max_cost = 3.f;
  ScaleDepth(1.1f);
  options_.min_ncc = -1.f;
  EXPECT_EQ(ShareKept(), 1.f);
  options_.geom_consistency_max_cost = 0.5f;
  EXPECT_EQ(ShareKept(), 0.f);
}

TEST_P(FilterHypothesesTest, NeedsAnAngleBetweenTheViews) {
  // About 0.4 degrees.
  AddSource(0.02, 0.0);
  AddSource(-0.02, 0.0);
  EXPECT_EQ(ShareKept(), 0.f);
  options_.min_triangulation_angle = 0.3f;
  EXPECT_EQ(ShareKept(), 1.f);
}

TEST_P(FilterHypothesesTest, NeedsTheAngleThatIsAskedFor) {
  // About 2 degrees.
  AddSource(0.1, 0.0);
  AddSource(-0.1, 0.0);
  options_.min_triangulation_angle = 1.5f;
  EXPECT_EQ(ShareKept(), 1.f);
  options_.min_triangulation_angle = 2.5f;
  EXPECT_EQ(ShareKept(), 0.f);
}

TEST_P(FilterHypothesesTest, NeedsImagesThatMatch) {
  AddThreeSources();
  for (int i = 0; i < 2; ++i) {
    for (float& value : scene_.SourceGray(i)) {
      value = 255.f - value;
    }
  }
  EXPECT_EQ(ShareKept(), 0.f);
  // Negatives have an NCC of -1.
  options_.min_ncc = -1.f;
  EXPECT_EQ(ShareKept(), 1.f);
}

TEST_P(FilterHypothesesTest, MatchesUnderThePlane) {
  AddThreeSources();
  options_.min_ncc = 0.9f;
  EXPECT_EQ(ShareKept(), 1.f);
  // Seen edge-on, the window is squeezed to a line.
  normal_ = Image<Vec3f>(kWidth, kHeight, Normalized(Vec3f{1.f, 0.f, -0.15f}));
  EXPECT_LT(ShareKept(), 0.1f);
}

TEST_P(FilterHypothesesTest, NeedsTexture) {
  AddThreeSources();
  scene_.Gray() = Image<float>(kWidth, kHeight, 128.f);
  EXPECT_EQ(ShareKept(), 0.f);
}

TEST_P(FilterHypothesesTest, RemovesPixelsWithoutHypothesis) {
  AddThreeSources();
  scene_.Depth()(30, 20) = 0.f;
  scene_.Depth()(31, 20) = -1.f;
  scene_.Depth()(32, 20) = std::numeric_limits<float>::quiet_NaN();
  normal_ = Image<Vec3f>(kWidth, kHeight, Normalized(Vec3f{0.3f, -0.2f, -1.f}));
  normal_(33, 20) = {};
  normal_(34, 20) = {0.f, 0.f, 1.f};
  const Image<float> filtered = Filter();
  for (int x = 30; x < 35; ++x) {
    EXPECT_EQ(filtered(x, 20), 0.f) << x;
  }
  EXPECT_GT(filtered(35, 20), 0.f);
  EXPECT_GT(filtered(29, 20), 0.f);
}

INSTANTIATE_TEST_SUITE_P(Scales,
                         FilterHypothesesTest,
                         testing::Values(1e-3f, 1.f, 1e3f));

}  // namespace
}  // namespace tsar
