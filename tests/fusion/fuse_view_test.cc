// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/fusion/fuse_view.h"

#include <cstring>

#include "tests/fusion/drawn_wall.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {
namespace {

using Wall = DrawnWall;

// Views that look at the wall from places ten pixels apart.
std::vector<FusionView> ViewsSideBySide(int count) {
  std::vector<FusionView> views;
  for (int i = 0; i < count; ++i) {
    views.push_back(Wall::View(i));
  }
  return views;
}

// The only point of a view, whose other pixels lose their depth.
struct OnePixel {
  static constexpr int kX = 25;
  static constexpr int kY = 15;

  explicit OnePixel(FusionView* view) {
    const FusionPixel kept = view->pixels(kX, kY);
    view->pixels = Image<FusionPixel>(Wall::kWidth, Wall::kHeight);
    view->pixels(kX, kY) = kept;
  }
};

TEST(FuseViewTest, EqualPixelsOfTwoImagesBecomeOnePointOfTheFirst) {
  const std::vector<FusionView> views = ViewsSideBySide(2);
  const std::vector<FusedPoint> first =
      Wall::Fuse(views, 0, Wall::DensestOptions());
  // The second image sees all but ten columns.
  ASSERT_EQ(first.size(), 30u * Wall::kHeight);
  EXPECT_TRUE(Wall::Fuse(views, 1, Wall::DensestOptions()).empty());
  for (const FusedPoint& point : first) {
    EXPECT_NEAR(point.position.z, Wall::kDepth, 1e-5f);
    EXPECT_GE(point.position.x, -1.01f);
    EXPECT_NEAR(point.normal.z, -1.f, 1e-6f);
    EXPECT_EQ(point.color.r, 100);
    EXPECT_EQ(point.sources, 1u);
  }
}

TEST(FuseViewTest, TheFinerPixelBecomesThePoint) {
  const std::vector<FusionView> views = {Wall::View(0), Wall::View(0, 2.0)};
  const std::vector<FusedPoint> far =
      Wall::Fuse(views, 0, Wall::DensestOptions());
  const std::vector<FusedPoint> near =
      Wall::Fuse(views, 1, Wall::DensestOptions());
  EXPECT_EQ(near.size(), size_t{Wall::kWidth} * Wall::kHeight);
  // The near image owns all that it sees.
  EXPECT_TRUE(far.empty());
}

TEST(FuseViewTest, NothingIsLeftToAnImageThatMayNotOwnIt) {
  const std::vector<FusionView> views = ViewsSideBySide(2);
  const std::vector<FusedPoint> points =
      FuseView(Wall::InputOf(views[1]),
               1,
               {{Wall::InputOf(views[0]), /*may_own=*/false, -1}},
               Wall::DensestOptions(),
               *Device::CreateCpu(1));
  EXPECT_EQ(points.size(), 30u * Wall::kHeight);
}

TEST(FuseViewTest, AsManyImagesAsAskedForHaveToAgree) {
  const std::vector<FusionView> views = ViewsSideBySide(3);
  FusionOptions options = Wall::DensestOptions();
  options.min_num_views = 3;
  EXPECT_EQ(Wall::Fuse(views, 0, options).size(), 20u * Wall::kHeight);
  options.min_num_views = 1;
  EXPECT_EQ(Wall::Fuse(views, 0, options).size(),
            size_t{Wall::kWidth} * Wall::kHeight);
  options.min_num_views = 4;
  EXPECT_TRUE(Wall::Fuse(views, 0, options).empty());
}

TEST(FuseViewTest, DepthsAndNormalsBeyondTheErrorsDoNotAgree) {
  std::vector<FusionView> views = ViewsSideBySide(2);
  OnePixel one(&views[0]);
  const auto count = [&](float depth, const Vec3f& normal) {
    views[0].pixels(OnePixel::kX, OnePixel::kY).depth = depth;
    EncodeNormal(normal, &views[0].pixels(OnePixel::kX, OnePixel::kY));
    return Wall::Fuse(views, 0, Wall::DensestOptions()).size();
  };
  const Vec3f towards = {0.f, 0.f, -1.f};
  const auto turned = [](double degrees) {
    const double angle = degrees * M_PI / 180.0;
    return Vec3f{static_cast<float>(std::sin(angle)),
                 0.f,
                 static_cast<float>(-std::cos(angle))};
  };
  EXPECT_EQ(count(Wall::kDepth, towards), 1u);
  EXPECT_EQ(count(0.991f * Wall::kDepth, towards), 1u);
  EXPECT_EQ(count(0.989f * Wall::kDepth, towards), 0u);
  EXPECT_EQ(count(Wall::kDepth, turned(29.9)), 1u);
  EXPECT_EQ(count(Wall::kDepth, turned(30.1)), 0u);
}

TEST(FuseViewTest, WhereADepthLeadsBackToHasToBeNear) {
  // Seen from far to the side, a small error of the depth is a large shift.
  std::vector<FusionView> views = {Wall::View(0), Wall::View(40)};
  views[1].camera.cx += 40 * Wall::kFocalLength / Wall::kDepth;
  OnePixel one(&views[0]);
  FusionOptions options = Wall::DensestOptions();
  FusionPixel& pixel = views[0].pixels(OnePixel::kX, OnePixel::kY);
  pixel.depth = 0.991f * Wall::kDepth;  // Reprojected 4 pixels off.
  EXPECT_TRUE(Wall::Fuse(views, 0, options).empty());
  options.max_reproj_error = 4.5;
  EXPECT_EQ(Wall::Fuse(views, 0, options).size(), 1u);
}

TEST(FuseViewTest, APointThatImagesSeeThroughIsLeftOut) {
  // Two images agree on a point in free space, two see the wall behind it.
  std::vector<FusionView> views;
  for (int i = 0; i < 4; ++i) {
    views.push_back(Wall::View(0.5 * i));
  }
  for (int i = 0; i < 2; ++i) {
    for (FusionPixel& pixel : views[i].pixels) {
      pixel.depth = 3.f;
      pixel.confidence = 100;
    }
  }
  const auto count = [&](uint8_t confidence, bool reject) {
    for (int i = 2; i < 4; ++i) {
      for (FusionPixel& pixel : views[i].pixels) {
        pixel.confidence = confidence;
      }
    }
    FusionOptions options = Wall::DensestOptions();
    options.reject_contradicted = reject;
    // What all four see.
    size_t num_common = 0;
    for (const FusedPoint& point : Wall::Fuse(views, 0, options)) {
      num_common += point.position.x > 0.f ? 1 : 0;
    }
    return num_common;
  };
  EXPECT_EQ(count(35, true), 0u);
  EXPECT_GT(count(35, false), 0u);
  EXPECT_EQ(count(30, true), count(35, false));
}

TEST(FuseViewTest, TheDepthIsTheMeanOrWeightedByPrecision) {
  std::vector<FusionView> views = ViewsSideBySide(3);
  const float depths[] = {4.f, 4.03f, 4.02f};
  const uint8_t confidences[] = {50, 100, 200};
  const float sigmas[] = {0.01f, 0.02f, 0.01f};
  double weighted = 0.0;
  double weights = 0.0;
  for (size_t i = 0; i < 3; ++i) {
    for (FusionPixel& pixel : views[i].pixels) {
      pixel.depth = depths[i];
      pixel.confidence = confidences[i];
      pixel.sigma = EncodeSigma(sigmas[i]);
    }
    const double weight =
        confidences[i] / std::pow(double{sigmas[i]} * depths[i], 2);
    weighted += weight * depths[i];
    weights += weight;
  }
  OnePixel one(&views[0]);
  FusionOptions options = Wall::DensestOptions();
  const auto depth = [&](bool weights_depths) {
    options.weights_depths = weights_depths;
    const std::vector<FusedPoint> points = Wall::Fuse(views, 0, options);
    EXPECT_EQ(points.size(), 1u);
    return points.empty() ? 0.f : points[0].position.z;
  };
  EXPECT_NEAR(depth(false), 12.05f / 3.f, 1e-5f);
  EXPECT_NEAR(depth(true), weighted / weights, 1e-4);
}

TEST(FuseViewTest, SourcesAreTheBitsOfANumberAndColorsAreAveraged) {
  std::vector<FusionView> views = ViewsSideBySide(3);
  for (FusionPixel& pixel : views[1].pixels) {
    pixel.depth = 2.f;  // Does not agree.
    pixel.confidence = 1;
  }
  for (FusionPixel& pixel : views[2].pixels) {
    pixel.color = {103, 150, 0};
  }
  OnePixel one(&views[0]);
  const std::vector<FusedPoint> points =
      Wall::Fuse(views, 0, Wall::DensestOptions());
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].sources, 2u);
  EXPECT_EQ(points[0].color.r, 102);  // 101.5.
  EXPECT_EQ(points[0].color.g, 150);
  EXPECT_EQ(points[0].color.b, 100);
}

TEST(FuseViewTest, OnePixelOfEachSquareBecomesAPoint) {
  const std::vector<FusionView> views = ViewsSideBySide(2);
  FusionOptions options;
  options.min_num_views = 1;
  options.point_spacing = 7;
  const std::vector<FusedPoint> points = Wall::Fuse(views, 0, options);
  // The last row of squares is cut off: its middle is the last row of pixels.
  ASSERT_EQ(points.size(), 6u * 5u);
  EXPECT_EQ(points[7].column, 10);
  EXPECT_EQ(points[7].row, 10);
  EXPECT_EQ(points.back().row, Wall::kHeight - 1);
}

TEST(FuseViewTest, NoiseDoesNotChooseTheNearestDepth) {
  // Among views at equal distance, the first one always gives the point,
  // whatever its error.
  std::vector<FusionView> views = ViewsSideBySide(5);
  uint32_t state = 1;
  for (FusionView& view : views) {
    for (FusionPixel& pixel : view.pixels) {
      state = state * 1664525u + 1013904223u;
      const float noise = static_cast<float>(state >> 8) / (1 << 24) - 0.5f;
      pixel.depth = Wall::kDepth * (1.f + 0.008f * noise);
    }
  }
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < 5; ++i) {
    for (const FusedPoint& point :
         Wall::Fuse(views, i, Wall::DensestOptions())) {
      const FusionView& view = views[i];
      sum += view.pixels(point.column, point.row).depth;
      ++count;
    }
  }
  ASSERT_GT(count, 1000);
  // The standard error is 0.0003.
  EXPECT_NEAR(sum / count, Wall::kDepth, 0.0015);
}

TEST(FuseViewTest, UnknownNormalsAgreeWithAny) {
  std::vector<FusionView> views = ViewsSideBySide(2);
  for (FusionPixel& pixel : views[1].pixels) {
    EncodeNormal({}, &pixel);
  }
  const std::vector<FusedPoint> points =
      Wall::Fuse(views, 0, Wall::DensestOptions());
  ASSERT_FALSE(points.empty());
  EXPECT_NEAR(points[0].normal.z, -1.f, 1e-6f);
}

}  // namespace
}  // namespace tsar
