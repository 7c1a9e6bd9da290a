// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/label_view.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <algorithm>
#include <vector>

#include "tests/scene/labeling/label_view_fixture.h"
#include "tests/support/synthetic_scene.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(LabelViewTest, SpreadsLabelsUpToAnEdgeOfTheImage) {
  options_.unlabeled_cost = 0.01f;
  Measure(WallAt(5.f), 2, 4);
  const ViewLabels all = Label({WallAt(5.f)});
  ExpectColumns(all, {0, 0, 0, 0, 0, 0, 0, 0});
  DrawEdgeLeftOf(6);
  ExpectColumns(Label({WallAt(5.f)}), {0, 0, 0, 0, 0, 0, -1, -1});
}

TEST_F(LabelViewTest, ChangesWithoutAnEdgeWhereTwoPlanesMeet) {
  // They meet at x = 50, not in the middle of the unmeasured part.
  const Vec3f crease = inputs_.intrinsics.Ray(49.5f, 0.f);
  const Plane left =
      Plane::FromPoint(crease, 5.f, Normalized({-0.2f, 0.f, -1.f}));
  const Plane right =
      Plane::FromPoint(crease, 5.f, Normalized({0.2f, 0.f, -1.f}));
  Measure(left, 0, 1);
  Measure(right, 6, 7);
  ExpectColumns(Label({left, right}), {0, 0, 0, 0, 0, 1, 1, 1});
  ExpectColumns(Label({right, left}), {1, 1, 1, 1, 1, 0, 0, 0});
}

TEST_F(LabelViewTest, ChangesAtAnEdgeWherePlanesAreApart) {
  Measure(WallAt(5.f), 0, 1);
  Measure(WallAt(7.f), 6, 7);
  for (const int column : {3, 5}) {
    inputs_.contrast = Image<float>(kWidth, kHeight, 0.f);
    DrawEdgeLeftOf(column);
    const ViewLabels view = Label({WallAt(5.f), WallAt(7.f)});
    std::vector<int> expected(kNumColumns, 0);
    std::fill(expected.begin() + column, expected.end(), 1);
    ExpectColumns(view, expected);
  }
}

// Copies of one surface do not meet where the image shows no edge, however
// close they are.
TEST_F(LabelViewTest, NearlyEqualPlanesDoNotShareASurface) {
  const Plane wall = WallAt(5.f);
  const Plane copy = WallAt(4.997f);
  Measure(wall, 0, 5);
  Measure(copy, 6, 7);
  ExpectColumns(Label({wall, copy}), {0, 0, 0, 0, 0, 0, 0, 0});
}

// A textureless box in front of a wall: if its right part were on the wall, it
// would project next to the box in the other views.
TEST_F(LabelViewTest, ColorsOfOtherViewsTellABareBoxFromTheWallBehindIt) {
  constexpr float kBox = 3.f;
  constexpr float kWall = 5.f;
  const auto draw = [&](double right) {
    Image<Rgb> color(kWidth, kHeight, kGray);
    const int shift = static_cast<int>(camera_.fx * right / kBox);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = std::max(3 * kSize - shift, 0); x < 5 * kSize - shift; ++x) {
        color(x, y) = {180, 170, 160};
      }
    }
    return color;
  };
  Measure(WallAt(kWall), 0, 2);
  Measure(WallAt(kBox), 3, 4);
  Measure(WallAt(kWall), 5, 7);
  // The box is known at its top and its bottom.
  for (int y = 2 * kSize; y < 4 * kSize; ++y) {
    for (int x = 3 * kSize; x < 5 * kSize; ++x) {
      inputs_.samples(x, y) = {};
    }
  }
  color_ = draw(0.0);
  for (const double right : {0.5, 0.7, 0.9}) {
    AddPicture(right, draw(right));
  }
  const auto labels_of_right_part = [&] {
    const ViewLabels labeled = Label({WallAt(kWall), WallAt(kBox)});
    std::vector<int> labels;
    for (const int row : {2, 3}) {
      labels.push_back(labeled.planes[row * kNumColumns + 4]);
    }
    return labels;
  };
  EXPECT_EQ(labels_of_right_part(), std::vector<int>(2, 1));
  options_.color_cost = 0.f;
  EXPECT_EQ(labels_of_right_part(), std::vector<int>(2, 0));
  // Two views are too few to decide.
  options_ = {};
  pictures_.pop_back();
  EXPECT_EQ(labels_of_right_part(), std::vector<int>(2, 0));
}

TEST_F(LabelViewTest, APlaneObservedOnOneSideDoesNotSpreadFar) {
  options_.unlabeled_cost = 0.01f;
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 2);
  const ViewLabels near = Label({WallAt(5.f)});
  for (int row = 0; row < kNumRows; ++row) {
    EXPECT_EQ(near.planes[row * kNumColumns + 2], 0);
    EXPECT_EQ(near.planes[row * kNumColumns + 7], -1);
  }
  // Close to its observations the plane is known.
  EXPECT_EQ(near.planes[2 * kNumColumns + 3], 0);
  options_.extrapolation_uncertainty = 0.f;
  ExpectColumns(Label({WallAt(5.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, NoPlaneThatAPriorsNormalContradictsFills) {
  const Plane wall = WallAt(3.f);
  const Plane side = DrawnPlane({-0.6f, 0.f, -0.8f}, 3.f);
  Measure(wall, 0, 2);
  Measure(side, 7, 7);
  options_.extrapolation_uncertainty = 0.f;
  DrawEdgesEverywhere();
  inputs_.prior.assessment.of_normals = PriorVerdict::kUsed;
  inputs_.prior.assessment.normal_sigma = 0.1f;
  inputs_.prior.normal_outlier_share = 0.1f;
  for (const int first_of_side : {3, 5, 7}) {
    inputs_.prior.normals.clear();
    for (int k = 0; k < kNumSuperpixels; ++k) {
      inputs_.prior.normals.push_back(
          k % kNumColumns < first_of_side ? wall.normal : side.normal);
    }
    const ViewLabels labeled = Label({wall, side});
    for (int k = 0; k < kNumSuperpixels; ++k) {
      const int label = labeled.planes[k];
      EXPECT_EQ(label == 0, k % kNumColumns < first_of_side)
          << k << " of " << first_of_side;
    }
  }
}

TEST_F(LabelViewTest, APlaneObservedAllAroundIsKnownInTheMiddle) {
  options_.unlabeled_cost = 0.01f;
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 7);
  for (int y = 2 * kSize; y < 4 * kSize; ++y) {
    for (int x = 2 * kSize; x < 6 * kSize; ++x) {
      inputs_.samples(x, y) = RayDepth{};
    }
  }
  options_.extrapolation_reach = 0.01f;
  ExpectColumns(Label({WallAt(5.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, APlaneIsUncertainWhereItsDepthIsUnknown) {
  options_.extrapolation_uncertainty = 0.f;
  DrawEdgesEverywhere();
  // Measured only along one row, about which the plane could rotate.
  Measure(WallAt(5.f), 0, 7);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (y != 25) {
        inputs_.samples(x, y) = RayDepth{};
      }
    }
  }
  const ViewLabels view = Label({WallAt(5.f)});
  EXPECT_EQ(view.planes[3], -1);
  EXPECT_EQ(view.planes[kNumColumns * (kNumRows - 1) + 3], -1);
  options_.uncertainty_cost = 0.f;
  ExpectColumns(Label({WallAt(5.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, ObservationsThatFitNoPlaneGetNone) {
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 7);
  Philox random(2, 0, 0);
  const int noisy = 2 * kNumColumns + 4;
  ForSamplesOf(noisy, [&](RayDepth* sample) {
    sample->z = 4.f + 2.f * random.NextFloat();
  });
  const ViewLabels view = Label({WallAt(5.f), WallAt(5.5f)});
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(view.planes[s], s == noisy ? -1 : 0);
    EXPECT_EQ(view.origins[s],
              s == noisy ? LabelOrigin::kNone : LabelOrigin::kMeasured);
  }
  options_.cost_of_unexplained = 2.f;
  EXPECT_NE(Label({WallAt(5.f), WallAt(5.5f)}).planes[noisy], -1);
}

// A chest in front of a wall: the wall was measured around it; on the chest
// there are only depths that other views confirm.
TEST_F(LabelViewTest, ConfirmedDepthsTellAPlaneFromTheOneBehindIt) {
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 5);
  Measure(WallAt(4.f), 6, 7);
  inputs_.confirmed_samples = inputs_.samples;
  const int chest = 2 * kNumColumns + 7;
  ForSamplesOf(chest, [](RayDepth* sample) { *sample = {}; });
  const std::vector<Plane> planes = {WallAt(5.f), WallAt(4.f)};
  const ViewLabels confirmed = Label(planes);
  EXPECT_EQ(confirmed.planes[chest], 1);
  EXPECT_GT(confirmed.strengths[chest], 0.8f);
  // Without them, the superpixel has no measurements.
  inputs_.confirmed_samples = {};
  EXPECT_EQ(Label(planes).strengths[chest], 0.f);
}

// A few are wrong on any bare surface; without a plane they are unexplained.
TEST_F(LabelViewTest, FewConfirmedDepthsDoNotTakeThePlane) {
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 7);
  const int bare = 2 * kNumColumns + 4;
  for (const int num_wrong : {0, 60, 100}) {
    int count = 0;
    ForSamplesOf(bare, [&](RayDepth* sample) {
      sample->z = count++ < num_wrong ? 3.f : 0.f;
    });
    inputs_.confirmed_samples = inputs_.samples;
    ForSamplesOf(bare, [](RayDepth* sample) { *sample = {}; });
    EXPECT_EQ(Label({WallAt(5.f)}).planes[bare], num_wrong < 100 ? 0 : -1);
  }
}

TEST_F(LabelViewTest, StrengthIsTheShareOfMeasurementsOnThePlane) {
  Measure(WallAt(5.f), 0, 7);
  const int mixed = 2 * kNumColumns + 4;
  int number = 0;
  ForSamplesOf(mixed, [&](RayDepth* sample) {
    sample->z = number++ % 4 == 0 ? 4.f : sample->z;
  });
  const ViewLabels view = Label({WallAt(5.f)});
  EXPECT_EQ(view.planes[mixed], 0);
  EXPECT_NEAR(view.strengths[mixed], 0.75f, 0.1f);
  EXPECT_GT(view.strengths[mixed + 1], 0.95f);
}

TEST_F(LabelViewTest, QualityTellsClearLabelsFromDoubtfulOnes) {
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 7);
  const int unmeasured = 2 * kNumColumns + 4;
  ForSamplesOf(unmeasured, [](RayDepth* sample) { *sample = {}; });
  const ViewLabels view = Label({WallAt(5.f)});
  const LabelQuality& clear = view.qualities[unmeasured + 1];
  EXPECT_GT(clear.strength.Value(), 0.95f);
  EXPECT_GT(clear.margin.Value(), 0.3f);
  const LabelQuality& doubtful = view.qualities[unmeasured];
  EXPECT_EQ(doubtful.strength.Value(), 0.f);
  EXPECT_LT(doubtful.margin.Value(), 0.1f);
  // A nearly equal plane removes the margin.
  EXPECT_LT(Label({WallAt(5.f), WallAt(5.001f)})
                .qualities[unmeasured + 1]
                .margin.Value(),
            0.05f);
}

TEST_F(LabelViewTest, APlaneBehindTheCameraIsNoLabel) {
  const Plane behind{{0.f, 0.f, 1.f}, 5.f};
  options_.uncertainty_cost = 0.f;
  Measure(WallAt(5.f), 0, 2);
  ExpectColumns(Label({behind, WallAt(5.f)}), {1, 1, 1, 1, 1, 1, 1, 1});
  ExpectColumns(Label({behind}), {-1, -1, -1, -1, -1, -1, -1, -1});
  // No depths at all.
  inputs_.samples = Image<RayDepth>(kWidth, kHeight);
  ExpectColumns(Label({behind}), {-1, -1, -1, -1, -1, -1, -1, -1});
  ExpectColumns(Label({WallAt(5.f)}), {-1, -1, -1, -1, -1, -1, -1, -1});
}

TEST_F(LabelViewTest, TakesOneSuperpixelAndOneWithoutPixels) {
  Measure(WallAt(5.f), 0, 7);
  inputs_.superpixels = Image<int>(kWidth, kHeight, 0);
  inputs_.num_superpixels = 1;
  EXPECT_EQ(Label({WallAt(5.f)}).planes, std::vector<int>{0});
  EXPECT_EQ(Label({WallAt(6.f)}).planes, std::vector<int>{-1});
  inputs_.num_superpixels = 2;
  EXPECT_EQ(Label({WallAt(5.f)}).planes[0], 0);
  inputs_ = EvidenceInputs{};
  EXPECT_TRUE(Label({WallAt(5.f)}).planes.empty());
}

TEST_F(LabelViewTest, TellsHowEachSuperpixelCameByItsPlane) {
  Measure(WallAt(3.f), 0, 2);
  DrawEdgeLeftOf(6);
  // Column 3 of the reference.
  AddSource([](int x, int) { return x >= 4 && x < 13 ? 3.f : 0.f; });
  const ViewLabels view = Label({WallAt(3.f)});
  ExpectColumns(view, {0, 0, 0, 0, 0, 0, -1, -1});
  ExpectOrigins(view,
                {LabelOrigin::kMeasured,
                 LabelOrigin::kMeasured,
                 LabelOrigin::kMeasured,
                 LabelOrigin::kCarried,
                 LabelOrigin::kGuessed,
                 LabelOrigin::kGuessed,
                 LabelOrigin::kNone,
                 LabelOrigin::kNone});
}

TEST_F(LabelViewTest, PlanesFarFromAllDepthsAreImpossible) {
  DrawEdgesEverywhere();
  options_.uncertainty_cost = 0.f;
  Measure(WallAt(5.f), 0, 2);
  // From half the nearest depth to twice the farthest.
  ExpectColumns(Label({WallAt(9.9f)}), {-1, -1, -1, 0, 0, 0, 0, 0});
  ExpectColumns(Label({WallAt(2.6f)}), {-1, -1, -1, 0, 0, 0, 0, 0});
  ExpectColumns(Label({WallAt(10.1f)}), {-1, -1, -1, -1, -1, -1, -1, -1});
  ExpectColumns(Label({WallAt(2.4f)}), {-1, -1, -1, -1, -1, -1, -1, -1});
}

TEST_F(LabelViewTest, DoesNotDependOnThePoseOfTheReference) {
  options_.unlabeled_cost = 0.01f;
  Measure(WallAt(3.f), 0, 2);
  DrawEdgeLeftOf(6);
  AddSource([](int x, int) {
    return x >= 4 && x < 13 ? 3.f : x >= 34 ? 6.f : 0.f;
  });
  const ViewLabels expected = Label({WallAt(3.f)});
  camera_.rotation =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized())
          .toRotationMatrix();
  camera_.translation = {1e5, -2e5, 300.0};
  const ViewLabels view = Label({WallAt(3.f)});
  EXPECT_EQ(view.planes, expected.planes);
  EXPECT_EQ(view.origins, expected.origins);
}

}  // namespace
}  // namespace tsar
