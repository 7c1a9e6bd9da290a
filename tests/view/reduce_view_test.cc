// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/reduce_view.h"

#include "colmap_tsar/compose/upsample_depth_flags.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/device_views.h"

#include <cmath>
#include <vector>

#include "tests/support/same_bytes.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/synthetic_views.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

// A view of one plane in every pixel, facing the camera.
ViewData FlatView(int width, int height, float depth) {
  ViewData view;
  view.camera = SyntheticCamera(width, height, width);
  view.color = Image<Rgb>(width, height);
  view.depth = Image<float>(width, height, depth);
  view.normal = Image<Vec3f>(width, height, Vec3f{0.f, 0.f, -1.f});
  return view;
}

TEST(FactorBetween, IsThatOfTheReduction) {
  for (const auto& [width, height] :
       {std::pair{1280, 960}, {1601, 7}, {2560, 1920}, {5000, 6001}}) {
    const int factor = ReductionFactor(width, height);
    EXPECT_EQ(FactorBetween(width,
                            height,
                            (width + factor - 1) / factor,
                            (height + factor - 1) / factor),
              factor);
  }
  EXPECT_EQ(FactorBetween(100, 80, 50, 41), 0);
  EXPECT_EQ(FactorBetween(100, 80, 101, 80), 0);
  EXPECT_EQ(FactorBetween(100, 80, 1, 1), 100);
  EXPECT_EQ(FactorBetween(3, 2, 1, 2), 0);
}

TEST(ReduceView, RaysGoThroughTheMiddleOfSquares) {
  const ViewData view = FlatView(11, 7, 2.f);
  for (const int factor : {2, 3, 4}) {
    SCOPED_TRACE(factor);
    const ViewData reduced = ReduceView(view, factor);
    EXPECT_EQ(reduced.depth.Width(), (11 + factor - 1) / factor);
    EXPECT_EQ(reduced.depth.Height(), (7 + factor - 1) / factor);
    EXPECT_EQ(reduced.camera.width, reduced.depth.Width());
    EXPECT_EQ(reduced.camera.height, reduced.depth.Height());
    EXPECT_TRUE(reduced.color.HasSizeOf(reduced.depth));
    EXPECT_TRUE(reduced.min_cost.Empty());
    const Intrinsics from = view.camera.GetIntrinsics();
    const Intrinsics to = reduced.camera.GetIntrinsics();
    for (int x = 0; x < reduced.depth.Width(); ++x) {
      const float middle = 0.5f * (factor - 1);
      const Vec3f expected = from.Ray(x * factor + middle, middle);
      EXPECT_NEAR(to.Ray(x, 0).x, expected.x, 1e-6f);
      EXPECT_NEAR(to.Ray(x, 0).y, expected.y, 1e-6f);
    }
  }
}

TEST(ReduceView, ASlantedPlaneStaysWhereItIs) {
  SyntheticViewsOptions options;
  // So few pixels that the plane's depth changes by more than 0.5 % in each.
  options.width = 31;
  options.has_bare_part = false;
  options.noise = 0.f;
  const SyntheticViews drawn = MakeSyntheticViews(options);
  for (const int factor : {2, 3}) {
    const ViewData reduced = ReduceView(drawn.views[0], factor);
    const Image<float> expected = DrawDepth(drawn.wall, reduced.camera);
    ASSERT_TRUE(reduced.depth.HasSizeOf(expected));
    for (size_t i = 0; i < expected.NumPixels(); ++i) {
      const float depth = expected.Data()[i];
      ASSERT_NEAR(reduced.depth.Data()[i], depth, 1e-5f * depth);
    }
    EXPECT_EQ(reduced.num_depths, static_cast<int64_t>(expected.NumPixels()));
  }
}

TEST(ReduceView, ADepthThatItsPlaneWouldCarryFarAwayStays) {
  ViewData view = FlatView(8, 8, 2.f);
  // Almost along the rays: half a pixel further it is somewhere else.
  for (Vec3f& normal : view.normal) {
    normal = Normalized({1.f, 0.f, -0.01f});
  }
  view.normal(0, 0) = {0.f, 0.f, 1.f};
  const ViewData reduced = ReduceView(view, 2);
  for (const float depth : reduced.depth) {
    EXPECT_EQ(depth, 2.f);
  }
}

TEST(ReduceView, TakesTheLowerMedianAndItsCost) {
  ViewData view = FlatView(4, 2, 0.f);
  view.min_cost = Image<float>(4, 2, 0.5f);
  const std::vector<float> depths = {2.006f, 2.002f, 2.f, 2.004f};
  for (int i = 0; i < 4; ++i) {
    view.depth(i % 2, i / 2) = depths[i];
    view.min_cost(i % 2, i / 2) = 0.1f * i;
  }
  const ViewData reduced = ReduceView(view, 2);
  ASSERT_EQ(reduced.depth.NumPixels(), 2u);
  EXPECT_EQ(reduced.depth(0, 0), 2.002f);
  EXPECT_EQ(reduced.min_cost(0, 0), 0.1f);
  EXPECT_EQ(reduced.depth(1, 0), 0.f);
  EXPECT_EQ(reduced.normal(1, 0), (Vec3f{}));
  EXPECT_EQ(reduced.min_cost(1, 0), kUndefinedCost);
  EXPECT_EQ(reduced.num_depths, 1);
}

TEST(ReduceView, OneMissingDepthOfNineDoesNotCount) {
  ViewData view = FlatView(6, 3, 2.f);
  const std::vector<float> depths = {
      2.007f, 0.f, 2.003f, 2.001f, 2.006f, 2.002f, 2.005f, 2.f, 2.004f};
  for (int i = 0; i < 9; ++i) {
    view.depth(i % 3, i / 3) = depths[i];
  }
  // Two are missing in the other block.
  view.depth(4, 1) = view.depth(5, 2) = 0.f;
  const ViewData reduced = ReduceView(view, 3);
  EXPECT_EQ(reduced.depth(0, 0), 2.003f);
  EXPECT_EQ(reduced.depth(1, 0), 0.f);
  EXPECT_EQ(reduced.num_depths, 1);
}

TEST(ReduceView, ColorsAreRoundedMeans) {
  ViewData view = FlatView(5, 3, 2.f);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 5; ++x) {
      const auto level = static_cast<uint8_t>(5 * y + x);
      view.color(x, y) = {level, static_cast<uint8_t>(2 * level), 255};
    }
  }
  const Image<Rgb> color = ReduceView(view, 2).color;
  ASSERT_EQ(color.NumPixels(), 6u);
  const auto expect = [&](int x, int y, int r, int g) {
    EXPECT_EQ(color(x, y).r, r) << x << ", " << y;
    EXPECT_EQ(color(x, y).g, g) << x << ", " << y;
    EXPECT_EQ(color(x, y).b, 255);
  };
  // Means of 3, 6.5 and, in blocks that the border cuts, 10.5 and 14.
  expect(0, 0, 3, 6);
  expect(2, 0, 7, 13);
  expect(0, 1, 11, 21);
  expect(2, 1, 14, 28);
}

TEST(ReduceHypotheses, AreThoseOfTheReducedView) {
  const auto device = CreateTestDevice(3);
  ViewData view = MakeSyntheticViews({}).views[0];
  for (size_t i = 0; i < view.depth.NumPixels(); i += 23) {
    view.depth.Data()[i] = 0.f;
  }
  const DeviceReference uploaded(view, *device);
  for (const int factor : {2, 3, 4, 7, 1000}) {
    const ViewData reduced = ReduceView(view, factor);
    const DepthNormalImages hypotheses =
        ReduceHypotheses(uploaded, factor, *device);
    EXPECT_TRUE(SameBytes(hypotheses.depth.ToHost(), reduced.depth)) << factor;
    EXPECT_TRUE(SameBytes(hypotheses.normal.ToHost(), reduced.normal))
        << factor;
  }
}

}  // namespace
}  // namespace tsar
