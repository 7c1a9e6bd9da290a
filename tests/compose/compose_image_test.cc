// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/compose_image.h"

#include "colmap_tsar/run/store/evidence_file.h"
#include "colmap_tsar/view/reduce_view.h"

#include <filesystem>
#include <utility>

#include "tests/support/for_each_pixel.h"
#include "tests/support/synthetic_views_test.h"
#include "tests/support/test_device.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

// A depth this close to the truth counts as right.
constexpr float kRight = 5e-3f;

class ComposeImageTest : public SyntheticViewsTest {
 protected:
  RefinedMaps RefineAll(const RefineOptions& options = {}) const {
    RefineResult result =
        Compose(Observe(drawn_.views.size(), options), options);
    EXPECT_EQ(result.reason_to_keep, "");
    return std::move(result.maps);
  }
  // Draws views of this size and reduces them. Returns the views as drawn.
  SyntheticViews DrawReduced(int width, int height, int factor) {
    SyntheticViewsOptions options;
    options.width = width;
    options.height = height;
    SyntheticViews whole = MakeSyntheticViews(options);
    drawn_ = whole;
    for (ViewData& view : drawn_.views) {
      view = ReduceView(view, factor);
    }
    return whole;
  }
  RefinedMaps RefineAlone() const {
    return RefineImage(drawn_.views[0],
                       UploadViews(drawn_.Sources(), *device_),
                       0,
                       {},
                       *device_)
        .maps;
  }
};

TEST_F(ComposeImageTest, AWallWithoutTextureGetsItsPlane) {
  const RefinedMaps maps = RefineAll();
  ExpectSoundMaps(maps);
  ExpectBarePartIsFilled(maps);
}

TEST_F(ComposeImageTest, LargeMapsAreJudgedAtASmallerSize) {
  constexpr int kWidth = 192;
  constexpr int kHeight = 144;
  const SyntheticViews whole =
      DrawReduced(kWidth, kHeight, ReductionFactor(kWidth, kHeight, 96));
  const auto evidence = Observe(drawn_.views.size());
  EXPECT_EQ(evidence[0]->flags.Width(), 96);
  EXPECT_EQ(evidence[0]->flags.Height(), 72);
  drawn_ = whole;
  const RefineResult result = Compose(evidence);
  EXPECT_EQ(result.reason_to_keep, "");
  ExpectSoundMaps(result.maps);
  int num_right = 0;
  int num_measured = 0;
  int num_with_depth = 0;
  ForEachPixel(kWidth, kHeight, [&](int x, int y) {
    num_right += RelativeError(result.maps.depth, x, y) < kRight ? 1 : 0;
    num_measured += result.maps.provenance(x, y) ==
                            static_cast<uint8_t>(Provenance::kMeasured)
                        ? 1
                        : 0;
    num_with_depth += Before()(x, y) > 0.f ? 1 : 0;
  });
  EXPECT_GT(num_right, 0.97 * kWidth * kHeight);
  // The flags of the reduced map reach the pixels of the large one.
  EXPECT_GT(num_measured, 0.7 * num_with_depth);
}

// The blocks of three pixels extend beyond the map and shift the principal
// point: the reduced camera is not the full one scaled.
TEST_F(ComposeImageTest, ComposesWithTheCameraThatObserved) {
  const SyntheticViews whole = DrawReduced(193, 145, 3);
  const auto evidence = Observe(drawn_.views.size());
  for (size_t i = 0; i < evidence.size(); ++i) {
    SCOPED_TRACE(i);
    // The reduced map is so small that it is its own raster.
    const Camera& observing = drawn_.views[i].camera;
    ASSERT_EQ(evidence[i]->width, 65);
    ASSERT_EQ(evidence[i]->height, 49);
    // The evidence is written to disk and read again, as between passes.
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.Path() / "evidence.bin";
    WriteEvidence(UserPath(path), "", *evidence[i]);
    const ViewEvidence read = ReadEvidence(path, EvidenceParts::kForNeighbors);
    const Camera composing =
        MakeObservedView(read, whole.views[i].camera).camera;
    EXPECT_EQ(composing.width, observing.width);
    EXPECT_EQ(composing.height, observing.height);
    const Intrinsics expected = observing.GetIntrinsics();
    const Intrinsics found = composing.GetIntrinsics();
    EXPECT_EQ(found.fx, expected.fx);
    EXPECT_EQ(found.fy, expected.fy);
    EXPECT_EQ(found.cx, expected.cx);
    EXPECT_EQ(found.cy, expected.cy);
    EXPECT_EQ(composing.rotation, observing.rotation);
    EXPECT_EQ(composing.translation, observing.translation);
  }
}

TEST_F(ComposeImageTest, NothingReliableGetsWorseThanWithASingleView) {
  const RefinedMaps together = RefineAll();
  const RefinedMaps alone = RefineAlone();
  double error_together = 0.0;
  double error_alone = 0.0;
  int num_right_together = 0;
  int num_right_alone = 0;
  ForEachPixel(Before().Width(), Before().Height(), [&](int x, int y) {
    const float of_together = RelativeError(together.depth, x, y);
    const float of_alone = RelativeError(alone.depth, x, y);
    num_right_together += of_together < kRight ? 1 : 0;
    num_right_alone += of_alone < kRight ? 1 : 0;
    if (RelativeError(Before(), x, y) > 2e-3f) {
      return;
    }
    if (together.depth(x, y) > 0.f) {
      ASSERT_LT(of_together, kRight) << x << ", " << y;
    }
    if (together.depth(x, y) > 0.f && alone.depth(x, y) > 0.f) {
      error_together += of_together;
      error_alone += of_alone;
    }
  });
  EXPECT_GE(num_right_together, num_right_alone);
  EXPECT_LE(error_together, error_alone);
}

TEST_F(ComposeImageTest, ScalingTheSceneByAPowerOfTwoScalesTheDepthsExactly) {
  const RefinedMaps maps = RefineAll();
  for (const float scale : {1024.f, 1.f / 1024.f}) {
    drawn_ = MakeSyntheticViews({});
    for (ViewData& view : drawn_.views) {
      view.camera.translation *= scale;
      for (float& depth : view.depth) {
        depth *= scale;
      }
    }
    ExpectSameMaps(maps, RefineAll(), scale);
  }
}

TEST_F(ComposeImageTest, TheViewsEvidenceAloneWillDo) {
  const RefineResult result = Compose(Observe(1));
  EXPECT_EQ(result.reason_to_keep, "");
  ExpectSoundMaps(result.maps);
}

// Without superpixels there is no evidence.
TEST_F(ComposeImageTest, EverySwitchLeavesSoundMaps) {
  ExpectSoundMapsOfEverySwitch(
      [&](const RefineOptions& options) {
        return Compose(Observe(2, options), options);
      },
      "refine");
}

TEST_F(ComposeImageTest, SaysWhereNothingIsLeft) {
  // Only wrong depths, none of which agrees with another view, even by chance.
  float nearest = 2.f;
  for (ViewData& view : drawn_.views) {
    Philox random(static_cast<uint32_t>(&view - drawn_.views.data()), 9, 9);
    for (float& depth : view.depth) {
      depth = nearest * (1.f + 0.3f * random.NextFloat());
    }
    nearest *= 1.5f;
  }
  const RefineResult result = Compose(Observe(drawn_.views.size()));
  EXPECT_EQ(result.reason_to_keep, kNothingReliable);
}

}  // namespace
}  // namespace tsar
