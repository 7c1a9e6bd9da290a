// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/label_view.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/scene_planes/gather_evidence.h"

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "tests/support/drawn_scene.h"
#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 80;
constexpr int kHeight = 60;
constexpr int kSize = 10;  // Of a superpixel.
constexpr int kNumColumns = kWidth / kSize;
constexpr int kNumRows = kHeight / kSize;
constexpr int kNumSuperpixels = kNumColumns * kNumRows;
constexpr float kStrongEdge = 100.f;

Plane WallAt(float depth) { return DrawnPlane({0.f, 0.f, -1.f}, depth); }

// Square superpixels, numbered row by row, in an image without edges, of which
// each test says what was measured.
class LabelViewTest : public testing::Test {
 protected:
  LabelViewTest() : camera_(DrawnCamera(kWidth, kHeight, 80.0)) {
    inputs_.superpixels = Image<int>(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        inputs_.superpixels(x, y) = y / kSize * kNumColumns + x / kSize;
      }
    }
    inputs_.num_superpixels = kNumSuperpixels;
    inputs_.superpixel_planes.resize(kNumSuperpixels);
    inputs_.samples = Image<RayDepth>(kWidth, kHeight);
    inputs_.texture = Image<float>(kWidth, kHeight, 5.f);
    inputs_.contrast = Image<float>(kWidth, kHeight, 0.f);
    inputs_.intrinsics = camera_.GetIntrinsics();
    inputs_.resolution.error_per_depth = 0.001f;
  }

  // The plane is measured in these columns of superpixels, both inclusive.
  void Measure(const Plane& plane, int first_column, int last_column) {
    const Image<RayDepth> samples =
        ToSamples(DrawDepth(plane, camera_), camera_);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = first_column * kSize; x < (last_column + 1) * kSize; ++x) {
        inputs_.samples(x, y) = samples(x, y);
      }
    }
  }

  void DrawEdgeLeftOf(int column) {
    for (int y = 0; y < kHeight; ++y) {
      inputs_.contrast(column * kSize - 1, y) = kStrongEdge;
      inputs_.contrast(column * kSize, y) = kStrongEdge;
    }
  }

  void DrawEdgesEverywhere() {
    inputs_.contrast = Image<float>(kWidth, kHeight, kStrongEdge);
  }

  // A second view, 1 to the right, of which this is known for certain. A point
  // at depth 3 lies 80 / 3 pixels further left in it.
  void AddWitness(const std::function<float(int x, int y)>& strong_depth) {
    witness_.resolution.error_per_depth = inputs_.resolution.error_per_depth;
    witness_.width = kWidth;
    witness_.height = kHeight;
    witness_.first_observation = {0};
    witness_.strong_depth = Image<float>(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        witness_.strong_depth(x, y) = strong_depth(x, y);
      }
    }
    num_witnesses_ = 1;
  }

  // Each superpixel is served by the first plane that explains its first
  // observation.
  LabeledView Label(const std::vector<Plane>& planes) const {
    const ViewEvidence evidence = GatherEvidence(inputs_, {});
    DiscoveredPlanes discovered;
    for (const Plane& plane : planes) {
      discovered.planes.push_back({ToWorldPlane(plane, camera_), 1.0});
    }
    std::vector<ObservedView> views = {{&evidence, camera_}};
    discovered.serving.emplace_back();
    for (int s = 0; s < evidence.NumSuperpixels(); ++s) {
      int serving = -1;
      if (evidence.first_observation[s] < evidence.first_observation[s + 1]) {
        const RayDepth& sample =
            evidence.observations[evidence.first_observation[s]].sample;
        for (size_t k = planes.size(); k-- > 0;) {
          if (RelativeDistance(planes[k], sample) < 1e-3f) {
            serving = static_cast<int>(k);
          }
        }
      }
      discovered.serving[0].push_back(serving);
    }
    for (int i = 0; i < num_witnesses_; ++i) {
      Camera camera = camera_;
      camera.translation.x() -= 1.0;
      camera.rotation = witness_turn_ * camera.rotation;
      camera.translation = witness_turn_ * camera.translation;
      views.push_back({&witness_, camera});
      discovered.serving.emplace_back();
    }
    // Several observations to each cell, as in rasters of usual size.
    PlaneSupportOptions support_options;
    support_options.num_cells = 16;
    return LabelView(views,
                     discovered,
                     FindPlaneSupport(views, discovered, support_options),
                     options_,
                     *device_);
  }

  // Columns have these labels from top to bottom.
  static void ExpectColumns(const LabeledView& view,
                            const std::vector<int>& expected) {
    ASSERT_EQ(view.labels.size(), static_cast<size_t>(kNumSuperpixels));
    for (int s = 0; s < kNumSuperpixels; ++s) {
      EXPECT_EQ(view.labels[s], expected[s % kNumColumns])
          << "column " << s % kNumColumns << ", row " << s / kNumColumns;
    }
  }

  static void ExpectEvidence(const LabeledView& view,
                             const std::vector<LabelEvidence>& expected) {
    for (int s = 0; s < kNumSuperpixels; ++s) {
      EXPECT_EQ(view.evidence[s], expected[s % kNumColumns])
          << "column " << s % kNumColumns << ", row " << s / kNumColumns;
    }
  }

  std::unique_ptr<Device> device_ = Device::CreateCpu(1);
  Camera camera_;
  EvidenceInputs inputs_;
  ViewEvidence witness_;
  int num_witnesses_ = 0;  // All see the same.
  Eigen::Matrix3d witness_turn_ = Eigen::Matrix3d::Identity();
  LabelOptions options_;
};

TEST_F(LabelViewTest, SpreadsLabelsUpToAnEdgeOfTheImage) {
  options_.cost_of_none = 0.01f;
  Measure(WallAt(5.f), 2, 4);
  const LabeledView all = Label({WallAt(5.f)});
  ExpectColumns(all, {0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(all.planes.size(), 1u);
  EXPECT_EQ(all.planes[0].offset, 5.f);
  DrawEdgeLeftOf(6);
  ExpectColumns(Label({WallAt(5.f)}), {0, 0, 0, 0, 0, 0, -1, -1});
}

TEST_F(LabelViewTest, ChangesWithoutAnEdgeWhereTwoPlanesMeet) {
  // They meet at x = 50, not in the middle of what was not measured.
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
    const LabeledView view = Label({WallAt(5.f), WallAt(7.f)});
    std::vector<int> expected(kNumColumns, 0);
    std::fill(expected.begin() + column, expected.end(), 1);
    ExpectColumns(view, expected);
  }
}

TEST_F(LabelViewTest, PlanesDoNotHideWhatOtherViewsSawThroughThem) {
  Measure(WallAt(3.f), 0, 2);
  AddWitness([](int, int) { return 6.f; });
  // The measured ones are contradicted too, but only by one view.
  const LabeledView view = Label({WallAt(3.f)});
  for (int s = 0; s < kNumSuperpixels; ++s) {
    if (s % kNumColumns >= 3) {
      EXPECT_EQ(view.labels[s], -1);
      EXPECT_EQ(view.evidence[s], LabelEvidence::kNone);
    }
  }
  options_.cost_of_contradiction = 0.f;
  ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, OnlyWhatLiesWellInFrontContradicts) {
  Measure(WallAt(3.f), 0, 2);
  // One pixel of disparity is 0.009 there.
  for (const float depth : {3.f + 1.3f * 0.009f, 2.5f, 0.f}) {
    AddWitness([&](int, int) { return depth; });
    ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
  }
  AddWitness([](int, int) { return 3.f + 2.f * 0.009f; });
  EXPECT_EQ(Label({WallAt(3.f)}).labels[5], -1);
}

TEST_F(LabelViewTest, ViewsThatLookAwaySayNothing) {
  Measure(WallAt(3.f), 0, 2);
  AddWitness([](int, int) { return 6.f; });
  witness_turn_.diagonal() << -1.0, 1.0, -1.0;
  ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, OtherViewsConfirmPlanes) {
  options_.cost_of_none = 0.f;
  DrawEdgesEverywhere();
  Measure(WallAt(3.f), 0, 2);
  ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, -1, -1, -1, -1, -1});
  // Columns 5 and 6 of the reference.
  AddWitness([](int x, int) { return x >= 24 && x < 43 ? 3.001f : 0.f; });
  const LabeledView view = Label({WallAt(3.f)});
  ExpectColumns(view, {0, 0, 0, -1, -1, 0, 0, -1});
  EXPECT_EQ(view.evidence[5], LabelEvidence::kCarried);
  options_.gain_of_confirmation = 0.f;
  ExpectColumns(Label({WallAt(3.f)}), {0, 0, 0, -1, -1, -1, -1, -1});
}

TEST_F(LabelViewTest, TwoViewsSayMoreThanOneButThreeDoNot) {
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 7);
  const auto label = [&](float depth, int num_witnesses) {
    AddWitness([&](int x, int) { return x < 60 ? depth : 0.f; });
    num_witnesses_ = num_witnesses;
    return Label({WallAt(5.f), WallAt(4.9f)}).labels[2 * kNumColumns + 3];
  };
  // Having no plane costs 0.6 here.
  options_.cost_of_contradiction = 0.7f;
  EXPECT_EQ(label(8.f, 1), 0);
  EXPECT_EQ(label(8.f, 2), -1);
  options_.cost_of_contradiction = 0.5f;
  EXPECT_EQ(label(8.f, 3), 0);
  // The nearer plane costs 1.
  options_.gain_of_confirmation = 1.2f;
  EXPECT_EQ(label(4.9f, 1), 0);
  EXPECT_EQ(label(4.9f, 2), 1);
  options_.gain_of_confirmation = 0.8f;
  EXPECT_EQ(label(4.9f, 3), 0);
}

TEST_F(LabelViewTest, TellsHowEachSuperpixelCameByItsPlane) {
  Measure(WallAt(3.f), 0, 2);
  DrawEdgeLeftOf(6);
  // Column 3 of the reference; 6 and 7 are seen through.
  AddWitness([](int x, int) {
    return x >= 4 && x < 13 ? 3.f : x >= 34 ? 6.f : 0.f;
  });
  const LabeledView view = Label({WallAt(3.f)});
  ExpectColumns(view, {0, 0, 0, 0, 0, 0, -1, -1});
  ExpectEvidence(view,
                 {LabelEvidence::kMeasured,
                  LabelEvidence::kMeasured,
                  LabelEvidence::kMeasured,
                  LabelEvidence::kCarried,
                  LabelEvidence::kGuessed,
                  LabelEvidence::kGuessed,
                  LabelEvidence::kNone,
                  LabelEvidence::kNone});
}

TEST_F(LabelViewTest, APlaneObservedOnOneSideDoesNotSpreadFar) {
  options_.cost_of_none = 0.01f;
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 2);
  const LabeledView near = Label({WallAt(5.f)});
  for (int row = 0; row < kNumRows; ++row) {
    EXPECT_EQ(near.labels[row * kNumColumns + 2], 0);
    EXPECT_EQ(near.labels[row * kNumColumns + 7], -1);
  }
  // Next to where it was observed it is known.
  EXPECT_EQ(near.labels[2 * kNumColumns + 3], 0);
  options_.doubt_of_extrapolation = 0.f;
  ExpectColumns(Label({WallAt(5.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, APlaneObservedAllAroundIsKnownInTheMiddle) {
  options_.cost_of_none = 0.01f;
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

TEST_F(LabelViewTest, APlaneIsDoubtedWhereItsDepthIsUnknown) {
  options_.doubt_of_extrapolation = 0.f;
  DrawEdgesEverywhere();
  // Along one row alone, about which the plane could turn.
  Measure(WallAt(5.f), 0, 7);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (y != 25) {
        inputs_.samples(x, y) = RayDepth{};
      }
    }
  }
  const LabeledView view = Label({WallAt(5.f)});
  EXPECT_EQ(view.labels[3], -1);
  EXPECT_EQ(view.labels[kNumColumns * (kNumRows - 1) + 3], -1);
  options_.cost_of_doubt = 0.f;
  ExpectColumns(Label({WallAt(5.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, ObservationsThatFitNoPlaneGetNone) {
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 7);
  Philox random(2, 0, 0);
  const int noisy = 2 * kNumColumns + 4;
  for (size_t i = 0; i < inputs_.samples.NumPixels(); ++i) {
    if (inputs_.superpixels.Data()[i] == noisy) {
      inputs_.samples.Data()[i].z = 4.f + 2.f * random.NextFloat();
    }
  }
  const LabeledView view = Label({WallAt(5.f), WallAt(5.5f)});
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(view.labels[s], s == noisy ? -1 : 0);
    EXPECT_EQ(view.evidence[s],
              s == noisy ? LabelEvidence::kNone : LabelEvidence::kMeasured);
  }
  options_.cost_of_unexplained = 2.f;
  EXPECT_NE(Label({WallAt(5.f), WallAt(5.5f)}).labels[noisy], -1);
}

TEST_F(LabelViewTest, NeighborsMayOutvoteObservationsButDoNotMeasure) {
  Measure(WallAt(5.f), 0, 7);
  const int wrong = 2 * kNumColumns + 4;
  for (size_t i = 0; i < inputs_.samples.NumPixels(); ++i) {
    if (inputs_.superpixels.Data()[i] == wrong) {
      inputs_.samples.Data()[i].z = 4.f;
    }
  }
  const LabeledView view = Label({WallAt(5.f)});
  EXPECT_EQ(view.labels[wrong], 0);
  EXPECT_EQ(view.evidence[wrong], LabelEvidence::kGuessed);
  EXPECT_EQ(view.evidence[wrong + 1], LabelEvidence::kMeasured);
}

TEST_F(LabelViewTest, TakesThePlaneThatFitsBest) {
  DrawEdgesEverywhere();
  // One pixel of disparity is 0.025: the other two are near enough to speak
  // for.
  Measure(WallAt(5.f), 0, 7);
  ExpectColumns(Label({WallAt(5.02f), WallAt(5.002f), WallAt(4.98f)}),
                {1, 1, 1, 1, 1, 1, 1, 1});
}

TEST_F(LabelViewTest, PlanesFarFromAllDepthsAreImpossible) {
  DrawEdgesEverywhere();
  options_.cost_of_doubt = 0.f;
  Measure(WallAt(5.f), 0, 2);
  // From half the nearest depth to twice the farthest.
  ExpectColumns(Label({WallAt(9.9f)}), {-1, -1, -1, 0, 0, 0, 0, 0});
  ExpectColumns(Label({WallAt(2.6f)}), {-1, -1, -1, 0, 0, 0, 0, 0});
  ExpectColumns(Label({WallAt(10.1f)}), {-1, -1, -1, -1, -1, -1, -1, -1});
  ExpectColumns(Label({WallAt(2.4f)}), {-1, -1, -1, -1, -1, -1, -1, -1});
}

TEST_F(LabelViewTest, APlaneBehindTheCameraIsNoLabel) {
  const Plane behind{{0.f, 0.f, 1.f}, 5.f};
  options_.cost_of_doubt = 0.f;
  Measure(WallAt(5.f), 0, 2);
  ExpectColumns(Label({behind, WallAt(5.f)}), {1, 1, 1, 1, 1, 1, 1, 1});
  ExpectColumns(Label({behind}), {-1, -1, -1, -1, -1, -1, -1, -1});
  // Nothing tells of depths.
  inputs_.samples = Image<RayDepth>(kWidth, kHeight);
  ExpectColumns(Label({behind}), {-1, -1, -1, -1, -1, -1, -1, -1});
  ExpectColumns(Label({WallAt(5.f)}), {-1, -1, -1, -1, -1, -1, -1, -1});
}

TEST_F(LabelViewTest, WithoutPlanesThereAreNoLabels) {
  Measure(WallAt(5.f), 0, 7);
  const LabeledView view = Label({});
  EXPECT_TRUE(view.planes.empty());
  ExpectColumns(view, {-1, -1, -1, -1, -1, -1, -1, -1});
  for (const LabelEvidence evidence : view.evidence) {
    EXPECT_EQ(evidence, LabelEvidence::kNone);
  }
}

TEST_F(LabelViewTest, TakesOneSuperpixelAndOneWithoutPixels) {
  Measure(WallAt(5.f), 0, 7);
  inputs_.superpixels = Image<int>(kWidth, kHeight, 0);
  inputs_.num_superpixels = 1;
  EXPECT_EQ(Label({WallAt(5.f)}).labels, std::vector<int>{0});
  EXPECT_EQ(Label({WallAt(6.f)}).labels, std::vector<int>{-1});
  inputs_.num_superpixels = 2;
  EXPECT_EQ(Label({WallAt(5.f)}).labels[0], 0);
  inputs_ = EvidenceInputs{};
  EXPECT_TRUE(Label({WallAt(5.f)}).labels.empty());
}

TEST_F(LabelViewTest, APlaneObservedAtOnePointStaysThere) {
  DrawEdgesEverywhere();
  const int y = 2 * kSize + 5;
  const int x = 4 * kSize + 5;
  const Vec3f ray = inputs_.intrinsics.Ray(x, y);
  inputs_.samples(x, y) = {ray.x, ray.y, 5.f};
  const LabeledView view = Label({WallAt(5.f)});
  EXPECT_EQ(std::count(view.labels.begin(), view.labels.end(), 0), 0);
}

TEST_F(LabelViewTest, LoneObservationsDoNotTellHowFarAPlaneReaches) {
  options_.cost_of_none = 0.01f;
  DrawEdgesEverywhere();
  Measure(WallAt(5.f), 0, 7);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x % kSize != 5 || y % kSize != 5) {
        inputs_.samples(x, y) = RayDepth{};
      }
    }
  }
  ExpectColumns(Label({WallAt(5.f)}), {-1, -1, -1, -1, -1, -1, -1, -1});
  options_.doubt_of_extrapolation = 0.f;
  ExpectColumns(Label({WallAt(5.f)}), {0, 0, 0, 0, 0, 0, 0, 0});
}

TEST_F(LabelViewTest, DoesNotDependOnThePoseOfTheReference) {
  options_.cost_of_none = 0.01f;
  Measure(WallAt(3.f), 0, 2);
  DrawEdgeLeftOf(6);
  AddWitness([](int x, int) {
    return x >= 4 && x < 13 ? 3.f : x >= 34 ? 6.f : 0.f;
  });
  const LabeledView expected = Label({WallAt(3.f)});
  camera_.rotation =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1.0, 2.0, 3.0).normalized())
          .toRotationMatrix();
  camera_.translation = {1e5, -2e5, 300.0};
  const LabeledView view = Label({WallAt(3.f)});
  EXPECT_EQ(view.labels, expected.labels);
  EXPECT_EQ(view.evidence, expected.evidence);
  EXPECT_NEAR(view.planes[0].offset, 3.f, 1e-4f);
}

TEST_F(LabelViewTest, DoesNotDependOnTheThreads) {
  options_.cost_of_none = 0.01f;
  Philox random(3, 0, 0);
  for (float& contrast : inputs_.contrast) {
    contrast = 20.f * random.NextFloat();
  }
  Measure(WallAt(3.f), 0, 1);
  Measure(WallAt(5.f), 5, 6);
  AddWitness([](int x, int y) { return x + y < 50 ? 3.f : 5.f; });
  const std::vector<Plane> planes = {
      WallAt(3.f), WallAt(5.f), WallAt(4.f), WallAt(5.01f)};
  const LabeledView expected = Label(planes);
  device_ = Device::CreateCpu(4);
  const LabeledView view = Label(planes);
  EXPECT_EQ(view.labels, expected.labels);
  EXPECT_EQ(view.evidence, expected.evidence);
}

}  // namespace
}  // namespace tsar
