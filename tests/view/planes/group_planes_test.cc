// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/group_planes.h"

#include "colmap_tsar/base/random.h"

#include <algorithm>
#include <vector>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_scene.h"
#include "tests/support/test_device.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 60;
constexpr int kHeight = 40;

// Label 0: a plane with outliers; 1: nothing measured; 2: two samples; 3: a
// second plane; 4: no pixels; -1: the last row.
class GroupPlanesTest : public testing::Test {
 protected:
  GroupPlanesTest()
      : device_(CreateTestDevice(2)),
        camera_(SyntheticCamera(kWidth, kHeight, 60.0)),
        first_(DrawnPlane({0.4f, -0.3f, -1.f}, 4.f)),
        second_(DrawnPlane({-0.5f, 0.1f, -1.f}, 6.f)),
        depth_(kWidth, kHeight, 0.f),
        labels_(kWidth, kHeight, -1) {
    Camera source = camera_;
    source.translation.x() = 0.4;
    scale_ = ComputeDisparityScale(camera_, {source});
    const Image<float> first_depth = DrawDepth(first_, camera_);
    const Image<float> second_depth = DrawDepth(second_, camera_);
    Philox random(3, 0, 0);
    ForEachPixel(kWidth, kHeight - 1, [&](int x, int y) {
      labels_(x, y) = x < 25 ? 0 : x < 30 ? 1 : x < 35 ? 2 : 3;
      if (labels_(x, y) == 0) {
        depth_(x, y) = random.NextBelow(3) == 0 ? 1.f + 9.f * random.NextFloat()
                                                : first_depth(x, y);
      } else if (labels_(x, y) == 3) {
        depth_(x, y) = second_depth(x, y);
      }
    });
    depth_(31, 5) = 3.f;
    depth_(33, 9) = 5.f;
  }

  std::vector<GroupPlane> Fit(const Image<float>& depth) const {
    const PixelGroups groups =
        GroupPixels(DeviceCopies(*device_)(labels_), 5, *device_);
    const DeviceImage<RayDepth> samples(*device_, ToSamples(depth, camera_));
    return FitGroupPlanes(groups, samples.View(), scale_, options_, *device_)
        .ToHost();
  }

  std::unique_ptr<Device> device_;
  Camera camera_;
  Plane first_;
  Plane second_;
  DisparityScale scale_;
  Image<float> depth_;
  Image<int> labels_;
  GroupPlaneOptions options_;
};

TEST_F(GroupPlanesTest, FindsTheDominantPlaneOfEachGroup) {
  const std::vector<GroupPlane> fits = Fit(depth_);
  ASSERT_EQ(fits.size(), 5u);
  ASSERT_TRUE(fits[0].plane.Valid());
  EXPECT_LT(AngleBetween(fits[0].plane.normal, first_.normal), 0.2f);
  EXPECT_NEAR(fits[0].plane.offset, first_.offset, 2e-3f * first_.offset);
  ASSERT_TRUE(fits[3].plane.Valid());
  EXPECT_LT(AngleBetween(fits[3].plane.normal, second_.normal), 0.01f);
  EXPECT_NEAR(fits[3].plane.offset, second_.offset, 1e-4f * second_.offset);
}

TEST_F(GroupPlanesTest, CountsPixelsSamplesAndInliers) {
  const std::vector<GroupPlane> fits = Fit(depth_);
  EXPECT_EQ(fits[0].num_pixels, 25 * 39);
  EXPECT_EQ(fits[0].num_samples, 25 * 39);
  EXPECT_NEAR(fits[0].num_inliers, 25 * 39 * 2 / 3, 50);
  EXPECT_EQ(fits[3].num_pixels, 25 * 39);
  EXPECT_EQ(fits[3].num_samples, 25 * 39);
  EXPECT_EQ(fits[3].num_inliers, 25 * 39);
  float nearest = 100.f;
  float farthest = 0.f;
  ForEachPixel(35, kWidth, 0, kHeight - 1, [&](int x, int y) {
    nearest = std::min(nearest, depth_(x, y));
    farthest = std::max(farthest, depth_(x, y));
  });
  EXPECT_EQ(fits[3].min_depth, nearest);
  EXPECT_EQ(fits[3].max_depth, farthest);
}

TEST_F(GroupPlanesTest, FindsNoneInGroupsThatSpanNone) {
  const std::vector<GroupPlane> fits = Fit(depth_);
  EXPECT_FALSE(fits[1].plane.Valid());
  EXPECT_EQ(fits[1].num_pixels, 5 * 39);
  EXPECT_EQ(fits[1].num_samples, 0);
  EXPECT_EQ(fits[1].min_depth, 0.f);
  EXPECT_EQ(fits[1].max_depth, 0.f);
  EXPECT_FALSE(fits[2].plane.Valid());
  EXPECT_EQ(fits[2].num_samples, 2);
  EXPECT_EQ(fits[2].num_inliers, 0);
  EXPECT_FALSE(fits[4].plane.Valid());
  EXPECT_EQ(fits[4].num_pixels, 0);
}

TEST_F(GroupPlanesTest, ScoresLargeGroupsOnSomeOfTheirSamples) {
  options_.max_scored_samples = 60;
  const std::vector<GroupPlane> fits = Fit(depth_);
  ASSERT_TRUE(fits[0].plane.Valid());
  EXPECT_LT(AngleBetween(fits[0].plane.normal, first_.normal), 0.2f);
  EXPECT_NEAR(fits[0].num_inliers, 25 * 39 * 2 / 3, 50);
}

TEST_F(GroupPlanesTest, DoesNotDependOnTheScenesScale) {
  const std::vector<GroupPlane> fits = Fit(depth_);
  for (const float factor : {1e-3f, 1e3f}) {
    Image<float> depth = depth_;
    for (float& z : depth) {
      z *= factor;
    }
    const DisparityScale scale = scale_;
    scale_.factor *= factor;
    scale_.error_per_depth /= factor;
    const std::vector<GroupPlane> scaled = Fit(depth);
    scale_ = scale;
    for (const int k : {0, 3}) {
      ASSERT_TRUE(scaled[k].plane.Valid());
      EXPECT_LT(AngleBetween(scaled[k].plane.normal, fits[k].plane.normal),
                0.02f);
      EXPECT_NEAR(scaled[k].plane.offset / factor,
                  fits[k].plane.offset,
                  1e-3f * fits[k].plane.offset);
    }
    EXPECT_FALSE(scaled[2].plane.Valid());
  }
}

}  // namespace
}  // namespace tsar
