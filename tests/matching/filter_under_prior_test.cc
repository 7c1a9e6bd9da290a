// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/plane_maps.h"

#include <memory>
#include <utility>

#include "tests/matching/textured_plane.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

// A wall seen by three sources, whose left half is bare in the reference.
class FilterUnderPriorTest : public testing::Test {
 protected:
  FilterUnderPriorTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 100.0)),
        scene_(DrawnPlane({0.3f, -0.2f, -1.f}, 3.f), camera_, *device_) {
    scene_.AddSource(SourceCamera(camera_, {0.5, 0.05, 0.0}, -0.15));
    scene_.AddSource(SourceCamera(camera_, {-0.5, 0.05, 0.0}, 0.15));
    scene_.AddSource(SourceCamera(camera_, {0.3, 0.4, 0.0}, -0.09));
    ForEachPixel(kWidth / 2, kHeight, [&](int x, int y) {
      scene_.Gray()(x, y) = 128.f;
    });
    const ReferenceView truth = scene_.Reference();
    prior_ =
        PlanesFromMaps(truth.intrinsics, truth.depth, truth.normal, *device_);
  }

  Image<float> Filter() {
    return FilterHypotheses(scene_.Reference(),
                            scene_.Sources(),
                            std::as_const(prior_).View(),
                            options_,
                            *device_)
        .ToHost();
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  TexturedPlane scene_;
  DeviceImage<Plane> prior_;
  HypothesisFilterOptions options_;
};

// Pixels of either half, away from its border.
constexpr int kBareX = 22;
constexpr int kTexturedX = 42;
constexpr int kY = 24;

TEST_F(FilterUnderPriorTest, KeepsBareDepthsOnThePrior) {
  const Image<float> filtered = Filter();
  EXPECT_GT(filtered(kBareX, kY), 0.f);
  EXPECT_GT(filtered(kTexturedX, kY), 0.f);
  // Without a prior a bare depth needs a match that it cannot have.
  const Image<float> without =
      FilterHypotheses(
          scene_.Reference(), scene_.Sources(), {}, options_, *device_)
          .ToHost();
  EXPECT_EQ(without(kBareX, kY), 0.f);
  EXPECT_EQ(without(kTexturedX, kY), filtered(kTexturedX, kY));
}

TEST_F(FilterUnderPriorTest, RemovesBareDepthsOffThePrior) {
  scene_.Depth()(kBareX, kY) *= 1.02f;
  options_.geom_consistency_max_cost = 10.f;
  EXPECT_EQ(Filter()(kBareX, kY), 0.f);
  options_.prior_tolerance = 0.03f;
  EXPECT_GT(Filter()(kBareX, kY), 0.f);
}

TEST_F(FilterUnderPriorTest, DistinctTextureHasToMatch) {
  for (int source = 0; source < 3; ++source) {
    for (float& value : scene_.SourceGray(source)) {
      value = 255.f - value;
    }
  }
  const Image<float> filtered = Filter();
  EXPECT_EQ(filtered(kTexturedX, kY), 0.f);
  EXPECT_GT(filtered(kBareX, kY), 0.f);
}

}  // namespace
}  // namespace tsar
