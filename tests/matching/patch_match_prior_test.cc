// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include <cmath>

#include "tests/matching/patch_match_fixture.h"
#include "tests/support/for_each_pixel.h"
#include "tests/support/test_device.h"

namespace tsar {
namespace {

class PatchMatchPriorTest : public PatchMatchTest {
 protected:
  // The scene's plane moved away by a share of its depth, in every pixel.
  DeviceImage<Plane> Prior(TexturedPlane& scene, float share) {
    Image<float> depth = scene.Depth();
    for (float& value : depth) {
      value *= 1.f + share;
    }
    return PlanesFromMaps(intrinsics_,
                          DeviceCopies(*device_)(depth),
                          scene.Reference().normal,
                          *device_);
  }
  // The wall loses its texture in all images.
  void Whitewash(TexturedPlane* scene) {
    scene->Gray() = Image<float>(kWidth, kHeight, 128.f);
    for (int i = 0; i < 4; ++i) {
      scene->SourceGray(i) = Image<float>(kWidth, kHeight, 128.f);
    }
  }
};

TEST_F(PatchMatchPriorTest, BareWallsTakeThePrior) {
  TexturedPlane scene = Scene(kTilt);
  Whitewash(&scene);
  const Buffer<SourceView> sources = Images(scene);
  ASSERT_LT(Compare(scene, Run(scene, sources, Draw()).planes).share, 0.1f);
  const DeviceImage<Plane> prior = Prior(scene, 0.f);
  const HostHypotheses found = Run(scene, sources, Draw(), 1, prior.View());
  EXPECT_EQ(Compare(scene, found.planes).share, 1.f);
}

TEST_F(PatchMatchPriorTest, TextureOverrulesAWrongPrior) {
  TexturedPlane scene = Scene(kTilt);
  // By 3 pixels of disparity; the waves of the texture repeat after 7.
  const DeviceImage<Plane> prior = Prior(scene, 0.2f);
  ExpectFound(scene, Run(scene, Images(scene), Draw(), 1, prior.View()).planes);
}

TEST_F(PatchMatchPriorTest, CostsTellTheDistanceFromThePrior) {
  TexturedPlane scene = Scene(kTilt);
  const Buffer<SourceView> sources = Images(scene);
  options_.num_iterations = 0;
  const auto costs = [&](float share) {
    const DeviceImage<Plane> prior = Prior(scene, share);
    return Run(scene, sources, TruePlanes(scene), 1, prior.View()).costs;
  };
  const Image<float> without = Run(scene, sources, TruePlanes(scene)).costs;
  const Image<float> on = costs(0.f);
  // A prior beyond by half its sigma of 1 %, and by five times as much.
  const Image<float> half = costs(0.005f);
  const Image<float> far = costs(0.05f);
  ForEachPixel(
      kMargin, kWidth - kMargin, kMargin, kHeight - kMargin, [&](int x, int y) {
        ASSERT_NEAR(on(x, y), without(x, y), 1e-5f);
        ASSERT_NEAR(half(x, y),
                    without(x, y) + 0.25f * options_.prior_weight,
                    0.01f * options_.prior_weight);
        ASSERT_NEAR(far(x, y), without(x, y) + options_.prior_weight, 1e-5f);
      });
}

// The left half keeps the planes that it has, right or wrong; the other finds
// its own.
TEST_F(PatchMatchPriorTest, PixelsKeepTheirPlanesIfToldSo) {
  TexturedPlane scene = Scene(kTilt);
  const Buffer<SourceView> sources = Images(scene);
  Image<uint8_t> keeps(kWidth, kHeight);
  ForEachPixel(kWidth / 2, kHeight, [&](int x, int y) { keeps(x, y) = 1; });
  const Image<Plane> drawn = Draw().ToHost();
  const Image<Plane> found =
      Run(scene, sources, Draw(), 1, {}, DeviceCopies(*device_)(keeps)).planes;
  const Image<float>& depth = scene.Depth();
  int num_right = 0;
  ForEachPixel(
      kMargin, kWidth - kMargin, kMargin, kHeight - kMargin, [&](int x, int y) {
        if (x < kWidth / 2) {
          ASSERT_EQ(std::memcmp(&found(x, y), &drawn(x, y), sizeof(Plane)), 0);
        } else {
          const float error =
              found(x, y).Depth(intrinsics_.Ray(x, y)) / depth(x, y) - 1.f;
          num_right += std::abs(error) < 0.005f ? 1 : 0;
        }
      });
  EXPECT_GT(num_right, 0.95 * (kWidth / 2 - kMargin) * (kHeight - 2 * kMargin));
}

}  // namespace
}  // namespace tsar
