// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/tools/stereo/planar_prior.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/tools/stereo/stereo_inputs.h"

#include <cstring>
#include <memory>
#include <vector>

#include "tests/support/external_writers.h"
#include "tests/support/mask_files.h"
#include "tests/support/synthetic_views.h"
#include "tests/tools/stereo/stereo_workspace_fixture.h"

namespace tsar {
namespace {

// A slanted wall whose bare part stands out of it by a tenth of its depth,
// which neither the images nor the measured depths around it tell.
class DepthPriorPlanesTest : public testing::Test {
 protected:
  static constexpr float kStandsOut = 0.9f;

  DepthPriorPlanesTest()
      : drawn_(MakeSyntheticViews({})),
        depth_(drawn_.truth),
        reliable_(Reference().depth),
        planes_(depth_.Width(), depth_.Height(), drawn_.wall) {
    for (int y = 0; y < depth_.Height(); ++y) {
      for (int x = 0; x < depth_.Width(); ++x) {
        if (IsBare(x, y)) {
          depth_(x, y) *= kStandsOut;
          reliable_(x, y) = 0.f;
        }
      }
    }
  }

  ViewData& Reference() { return drawn_.views[0]; }
  Vec3f Ray(int x, int y) {
    return Reference().camera.GetIntrinsics().Ray(x, y);
  }
  bool IsBare(int x, int y) {
    return SyntheticViews::IsBare(Ray(x, y) * drawn_.truth(x, y));
  }
  // Whether the pixel lies in the bare part, well away from its border.
  bool IsInside(int x, int y) {
    return IsBare(x - 4, y - 4) && IsBare(x + 4, y + 4);
  }

  void SetPrior(Image<float> values, PriorType type = PriorType::kAuto) {
    auto prior = std::make_shared<DepthPrior>();
    prior->type = type;
    prior->values = std::move(values);
    Reference().prior = std::move(prior);
  }
  // The drawn depth in another unit.
  Image<float> RightPrior() const {
    Image<float> values = depth_;
    for (float& value : values) {
      value *= 3.f;
    }
    return values;
  }
  static Image<float> RandomPrior(int width, int height) {
    Image<float> values(width, height);
    Philox random(1, 0, 0);
    for (float& value : values) {
      value = 1.f + random.NextFloat();
    }
    return values;
  }

  PriorAssessment Use() {
    return UseDepthPrior(Reference(),
                         DeviceImage<float>(*device_, reliable_),
                         *device_,
                         &planes_);
  }

  std::unique_ptr<Device> device_ = Device::CreateCpu(2);
  SyntheticViews drawn_;
  Image<float> depth_;
  Image<float> reliable_;
  Image<Plane> planes_;
};

TEST_F(DepthPriorPlanesTest, ReplacesThePlanesThatItContradictsAlone) {
  SetPrior(RightPrior());
  EXPECT_EQ(Use().verdict, PriorVerdict::kUsed);
  int num_inside = 0;
  for (int y = 5; y < planes_.Height() - 5; ++y) {
    for (int x = 5; x < planes_.Width() - 5; ++x) {
      const Plane& plane = planes_(x, y);
      if (IsInside(x, y)) {
        ++num_inside;
        ASSERT_NEAR(plane.Depth(Ray(x, y)) / depth_(x, y), 1.f, 0.01f)
            << x << ", " << y;
        ASSERT_GT(Dot(plane.normal, drawn_.wall.normal), 0.98f);
      } else if (reliable_(x, y) > 0.f) {
        ASSERT_EQ(plane.offset, drawn_.wall.offset) << x << ", " << y;
        ASSERT_TRUE(plane.normal == drawn_.wall.normal);
      }
    }
  }
  EXPECT_GT(num_inside, 100);
}

TEST_F(DepthPriorPlanesTest, ContinuesWhereThereIsNoPlane) {
  SetPrior(RightPrior());
  planes_ = Image<Plane>(depth_.Width(), depth_.Height());
  Use();
  EXPECT_NEAR(planes_(8, 8).Depth(Ray(8, 8)) / depth_(8, 8), 1.f, 0.01f);
}

TEST_F(DepthPriorPlanesTest, AWrongPriorChangesNothing) {
  const Image<Plane> before = planes_;
  for (const bool is_empty : {false, true}) {
    SetPrior(is_empty ? Image<float>()
                      : RandomPrior(depth_.Width(), depth_.Height()));
    EXPECT_EQ(Use().verdict,
              is_empty ? PriorVerdict::kNoDepth : PriorVerdict::kUnlike);
    EXPECT_EQ(
        std::memcmp(
            planes_.Data(), before.Data(), before.NumPixels() * sizeof(Plane)),
        0);
  }
}

// Without texture of their own, depths are no samples, however many there are.
TEST_F(DepthPriorPlanesTest, IsAlignedOnTextureAlone) {
  SetPrior(RightPrior());
  Reference().color =
      Image<Rgb>(depth_.Width(), depth_.Height(), Rgb{90, 90, 90});
  EXPECT_EQ(Use().verdict, PriorVerdict::kFewMeasured);
}

TEST_F(DepthPriorPlanesTest, FillsTheBarePartAndLeavesWhatWasMeasured) {
  StereoOptions options;
  options.num_geometric_passes = 1;
  const auto match = [&] {
    return MatchImageGeometrically(Reference(),
                                   drawn_.Sources(),
                                   {2.0, 10.0},
                                   1,
                                   /*pass=*/0,
                                   /*keeps_holes=*/false,
                                   options,
                                   *device_);
  };
  const StereoMaps without = match();
  EXPECT_EQ(without.prior.verdict, PriorVerdict::kNone);
  SetPrior(RightPrior());
  const StereoMaps with = match();
  EXPECT_EQ(with.prior.verdict, PriorVerdict::kUsed);
  int num_filled = 0;
  int num_right = 0;
  int num_right_without = 0;
  for (int y = 0; y < depth_.Height(); ++y) {
    for (int x = 0; x < depth_.Width(); ++x) {
      if (without.min_cost(x, y) != kUndefinedCost &&
          without.depth(x, y) > 0.f) {
        ASSERT_EQ(with.depth(x, y), without.depth(x, y));
        ASSERT_EQ(with.min_cost(x, y), without.min_cost(x, y));
      } else if (x > 4 && y > 4 && IsInside(x, y)) {
        const auto is_right = [&](const StereoMaps& maps) {
          return std::abs(maps.depth(x, y) - depth_(x, y)) <
                         0.02f * depth_(x, y)
                     ? 1
                     : 0;
        };
        ++num_filled;
        num_right += is_right(with);
        num_right_without += is_right(without);
        ASSERT_EQ(with.min_cost(x, y), kUndefinedCost);
      }
    }
  }
  EXPECT_GT(num_filled, 50);
  EXPECT_GT(num_right, 0.95 * num_filled);
  EXPECT_LT(num_right_without, 0.05 * num_filled);
}

// With priors of v0.png and left/v2.png that say nothing of the wall.
class StereoDepthPriorTest : public StereoWorkspaceTest {
 protected:
  void SetUp() override {
    StereoWorkspaceTest::SetUp();
    std::filesystem::create_directories(priors_ / "left");
    WritePrior("v0.png.pfm", 1);
    WritePrior("left/v2.pfm", 2);
  }
  void WritePrior(const std::string& name, uint32_t seed) const {
    Philox random(seed, 0, 0);
    std::vector<float> values(8 * 6);
    for (float& value : values) {
      value = 1.f + random.NextFloat();
    }
    WriteText(priors_ / name, PfmBytes(8, 6, 1, values, true));
  }

  const std::filesystem::path priors_ = folder_.Path() / "priors";
};

TEST_F(StereoDepthPriorTest, WrongPriorsLeaveTheMapsAsWithout) {
  options_.max_image_size = StereoOptions().max_image_size;
  EXPECT_FALSE(Run().num_priors);
  const auto without = Maps();
  prior_path_ = priors_;
  const StereoSummary summary = Run(/*overwrite=*/true);
  EXPECT_EQ(summary.num_skipped, 0);
  EXPECT_EQ(summary.num_priors, 2);
  ASSERT_EQ(summary.dropped_priors.size(), 2u);
  for (const StereoSummary::ImageReason& image : summary.dropped_priors) {
    EXPECT_NE(image.reason.find("depth prior not used: as "), std::string::npos)
        << image.reason;
  }
  EXPECT_TRUE(Maps() == without);
  EXPECT_EQ(Run().num_skipped, 4);
}

TEST_F(StereoDepthPriorTest, MakesMapsAnewWherePriorsHaveChanged) {
  Run();
  const std::filesystem::path inputs = root_ / "stereo/tsar_stereo/inputs.txt";
  const std::string without = ReadText(inputs);
  const std::string changed =
      "its depth prior has changed since the maps were made, and 1 other image "
      "has changed, too; give overwrite 1";
  prior_path_ = priors_;
  ExpectRefused(ErrorCode::kUnsupported, changed);
  Run(/*overwrite=*/true);
  EXPECT_EQ(Run().num_skipped, 4);
  prior_type_ = PriorType::kInverse;
  ExpectRefused(ErrorCode::kUnsupported, changed);
  prior_type_ = PriorType::kAuto;
  WritePrior("v0.png.pfm", 3);
  Touch(priors_ / "v0.png.pfm");
  ExpectRefused(
      ErrorCode::kUnsupported,
      "images/v0.png: its depth prior has changed since the maps were made; "
      "give overwrite 1");
  Run(/*overwrite=*/true);
  prior_path_.clear();
  ExpectRefused(ErrorCode::kUnsupported, changed);
  Run(/*overwrite=*/true);
  EXPECT_EQ(ReadText(inputs), without);
}

TEST_F(StereoDepthPriorTest, RefusesPriorsThatHaveNoUseOrDoNotFit) {
  prior_path_ = priors_;
  for (bool* option : {&options_.planar_prior, &options_.geom_consistency}) {
    *option = false;
    ExpectRefused(ErrorCode::kBadOption, "prior_path: depth priors");
    *option = true;
  }
  WriteText(priors_ / "v3.png.pfm",
            PfmBytes(6, 8, 1, std::vector<float>(48, 1.f), true));
  ExpectRefused(ErrorCode::kMismatch, "v3.png.pfm: the depth prior has 6 x 8");
  prior_path_ = root_ / "sparse";
  ExpectRefused(ErrorCode::kNotFound, "holds no depth prior of any image");
  prior_path_.clear();
  prior_type_ = PriorType::kMetric;
  ExpectRefused(ErrorCode::kBadOption, "give prior_path as well");
}

}  // namespace
}  // namespace tsar
