// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/filter_hypotheses.h"

#include "tests/matching/textured_plane.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

// A plane three units off, seen by sources half a unit aside: 9 degrees.
class DistinctMatchesTest : public testing::Test {
 protected:
  DistinctMatchesTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 100.0)),
        scene_(DrawnPlane({0.3f, -0.2f, -1.f}, 3.f), camera_, *device_) {
    AddSource(0.5);
    AddSource(-0.5);
  }

  void AddSource(double x) {
    scene_.AddSource(SourceCamera(camera_, {x, 0.05, 0.0}, -0.3 * x));
  }
  // The same levels at the same pixels of the reference and of the sources, as
  // of shading: wherever it is compared, it matches.
  template <typename Level>
  void Paint(const Level& level) {
    for (Image<float>* gray :
         {&scene_.Gray(), &scene_.SourceGray(0), &scene_.SourceGray(1)}) {
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
          (*gray)(x, y) = level(x, y);
        }
      }
    }
  }
  void ScaleAllDepths(float factor) {
    for (Image<float>* depth :
         {&scene_.Depth(), &scene_.SourceDepth(0), &scene_.SourceDepth(1)}) {
      for (float& value : *depth) {
        value *= factor;
      }
    }
  }

  Image<uint8_t> Count() {
    DeviceImage<uint8_t> counts(*device_, Image<uint8_t>(kWidth, kHeight));
    for (const SourceView& source : scene_.HostSources()) {
      AddDistinctMatches(
          scene_.Reference(), source, options_, counts.View(), *device_);
    }
    return counts.ToHost();
  }
  // Of the pixels in the middle, which all sources see, the share with at least
  // this count.
  double ShareWith(int min_count) {
    const Image<uint8_t> counts = Count();
    int num_pixels = 0;
    for (int y = 16; y < 32; ++y) {
      for (int x = 22; x < 42; ++x) {
        num_pixels += counts(x, y) >= min_count ? 1 : 0;
      }
    }
    return num_pixels / (16.0 * 20.0);
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  TexturedPlane scene_;
  HypothesisFilterOptions options_;
};

TEST_F(DistinctMatchesTest, CountsTheSourcesOfATexturedPlane) {
  EXPECT_EQ(ShareWith(2), 1.0);
  EXPECT_EQ(ShareWith(3), 0.0);
}

TEST_F(DistinctMatchesTest, StopsAtTheNumberAskedFor) {
  options_.min_num_consistent = 1;
  EXPECT_EQ(ShareWith(1), 1.0);
  EXPECT_EQ(ShareWith(2), 0.0);
}

// All views have the same wrong plane, 9 pixels beside the right one.
TEST_F(DistinctMatchesTest, ASharedWrongPlaneIsNoMatch) {
  ScaleAllDepths(1.5f);
  options_.geom_consistency_max_cost = 100.f;
  EXPECT_LT(ShareWith(2), 0.05);
}

// The depths agree, and matching cannot tell them from others.
TEST_F(DistinctMatchesTest, ShadingIsNoMatch) {
  Paint([](int x, int y) { return 60.f + 1.5f * x + 0.5f * y; });
  EXPECT_LT(ShareWith(1), 0.25);
  EXPECT_LT(ShareWith(2), 0.05);
}

TEST_F(DistinctMatchesTest, TheSourcesDepthHasToAgree) {
  for (float& depth : scene_.SourceDepth(0)) {
    depth *= 1.1f;
  }
  EXPECT_EQ(ShareWith(1), 1.0);
  EXPECT_EQ(ShareWith(2), 0.0);
}

TEST_F(DistinctMatchesTest, RaysHaveToTellDepth) {
  options_.min_triangulation_angle = 20.f;
  EXPECT_EQ(ShareWith(1), 0.0);
}

}  // namespace
}  // namespace tsar
