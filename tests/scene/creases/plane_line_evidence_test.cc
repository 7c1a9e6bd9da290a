// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// What views tell of lines, before any of them is a crease.

#include "colmap_tsar/scene/creases/line_evidence.h"
#include "colmap_tsar/scene/evidence/plane_indices.h"

#include "tests/scene/creases/drawn_wall_fixture.h"

namespace tsar {
namespace {

// A line at this height of the wall, above which there may be a ceiling.
constexpr double kLine = -1.0;

class PlaneLineEvidenceTest : public DrawnWallTest {
 protected:
  PlaneLineEvidenceTest()
      : camera_(CameraAt({0.2, 0.05, 0.0})),
        evidence_(BareEvidence(camera_)),
        labels_(AllOn(0)) {}

  // Of one line.
  static LineEvidence Sum(const std::vector<ViewLineEvidence>& of_view) {
    LineEvidenceSum sum(1);
    sum.Add(of_view);
    return sum.Get()[0];
  }

  LineEvidence Test() const {
    SharedLine shared;
    shared.line = {
        0, 1, static_cast<float>(kLine), static_cast<float>(kPixel), 3.f};
    shared.num_views = 3;
    std::vector<int> copies;
    for (size_t i = 0; i < model_.planes.size(); ++i) {
      copies.push_back(static_cast<int>(i));
    }
    return Sum(TestPlaneLines(
        {&evidence_, camera_}, Renumber(labels_, copies), {shared}, model_));
  }

  // These depths below the line and above it; 0: none.
  void MeasureSides(double below, double above) {
    Measure(
        camera_,
        [&](const Eigen::Vector3d& point) {
          return Depth{(point.y() > kLine ? below : above) *
                       DepthOf(camera_, point)};
        },
        &evidence_);
  }

  double PixelsAbove() const {
    double count = 0.0;
    for (int y = 0; y < kHeight; ++y) {
      count += OnWall(camera_, 0.5 * kWidth, y).y() < kLine ? kWidth : 0;
    }
    return count;
  }

  Camera camera_;
  ViewEvidence evidence_;
  std::vector<int> labels_;
};

TEST_F(PlaneLineEvidenceTest, CountsTheAreaWhereThePlaneMayEnd) {
  const LineEvidence found = Test();
  // But for three pixels next to the line.
  EXPECT_NEAR(found.sides[0].area, PixelsAbove() - 3 * kWidth, kWidth);
  EXPECT_EQ(found.sides[0].num_views, 1);
  // The camera is below the ceiling, hence above no floor that begins here.
  EXPECT_EQ(found.sides[1].area, 0.0);
  EXPECT_EQ(found.sides[1].num_views, 0);
  EXPECT_EQ(found.sides[0].measured + found.sides[1].measured, 0.0);
}

TEST_F(PlaneLineEvidenceTest, CountsWhatIsMeasuredOnThePlane) {
  MeasureSides(1.0, 0.0);
  LineEvidence found = Test();
  EXPECT_EQ(found.sides[0].measured, 0.0);
  // Their confidence is a half.
  const double below = kWidth * kHeight - PixelsAbove() - 3 * kWidth;
  EXPECT_NEAR(found.sides[1].measured, 0.5 * below, 0.05 * below);
  MeasureSides(1.0, 1.0);
  found = Test();
  EXPECT_NEAR(found.sides[0].measured,
              0.5 * found.sides[0].area,
              0.1 * found.sides[0].area);
  // One pixel of disparity is 0.005 of the depth.
  MeasureSides(1.004, 1.006);
  found = Test();
  EXPECT_GT(found.sides[1].measured, 0.4 * below);
  EXPECT_EQ(found.sides[0].measured, 0.0);
}

TEST_F(PlaneLineEvidenceTest, PlanesOfRegionsAreNoMeasurements) {
  Measure(
      camera_,
      [&](const Eigen::Vector3d& point) {
        return Depth{DepthOf(camera_, point), /*is_measured=*/false};
      },
      &evidence_);
  const LineEvidence found = Test();
  EXPECT_EQ(found.sides[0].measured + found.sides[1].measured, 0.0);
  EXPECT_EQ(found.sides[0].through, 0.0);
}

TEST_F(PlaneLineEvidenceTest, CountsWhatIsSeenThroughWhatBeginsThere) {
  MeasureSides(0.0, 1.3);
  LineEvidence found = Test();
  EXPECT_GT(found.sides[0].through, 0.4 * found.sides[0].area);
  EXPECT_EQ(found.sides[0].measured, 0.0);
  // On the ceiling, and before it.
  for (const double share : {1.0, 0.7}) {
    Measure(
        camera_,
        [&](const Eigen::Vector3d& point) {
          const double to_ceiling = (kLine - camera_.Center().y()) /
                                    (point.y() - camera_.Center().y());
          return Depth{point.y() < kLine
                           ? share * to_ceiling * DepthOf(camera_, point)
                           : 0.0};
        },
        &evidence_);
    found = Test();
    EXPECT_EQ(found.sides[0].through, 0.0) << share;
    EXPECT_EQ(found.sides[0].measured, 0.0) << share;
  }
  // What is measured beside the wall further down does not matter.
  MeasureSides(1.3, 0.0);
  EXPECT_EQ(Test().sides[0].through, 0.0);
}

TEST_F(PlaneLineEvidenceTest, ACameraAboveTheCeilingDoesNotSeeIt) {
  camera_ = CameraAt({0.2, -1.5, 0.0});
  evidence_ = BareEvidence(camera_);
  MeasureSides(1.3, 1.3);
  const LineEvidence found = Test();
  EXPECT_EQ(found.sides[0].num_views, 0);
  EXPECT_EQ(found.sides[0].through, 0.0);
}

TEST_F(PlaneLineEvidenceTest, AreasOfOtherPlanesDoNotCount) {
  const int other = AddPlane({0.0, 1.0, 0.0}, {0.0, kLine, 4.0}, 1, 100.0);
  RelabelAbove(kLine + 0.5, camera_, other, &labels_);
  LineEvidence found = Test();
  EXPECT_EQ(found.sides[0].area, 0.0);
  EXPECT_EQ(found.sides[0].num_views, 0);
  // Those of none do.
  RelabelAbove(kLine + 0.5, camera_, -1, &labels_);
  EXPECT_GT(Test().sides[0].area, 0.8 * (PixelsAbove() - 3 * kWidth));
}

TEST_F(PlaneLineEvidenceTest, AViewWithoutThePlaneTellsNothing) {
  labels_ = AllOn(-1);
  EXPECT_TRUE(
      TestPlaneLines(
          {&evidence_, camera_}, Renumber(labels_, {0}), {SharedLine()}, model_)
          .empty());
  SharedLine of_other;
  of_other.line.plane = 1;
  EXPECT_TRUE(
      TestPlaneLines({&evidence_, camera_}, AllOn(0), {of_other}, model_)
          .empty());
}

TEST_F(PlaneLineEvidenceTest, CopiesShowThePlane) {
  AddPlane({0.0, 0.0, -1.0}, {0.0, 0.0, kDistance + 0.01}, 2, 100.0);
  const LineEvidence expected = Test();
  labels_ = AllOn(1);
  SharedLine shared;
  shared.line = {
      0, 1, static_cast<float>(kLine), static_cast<float>(kPixel), 3.f};
  const LineEvidence found = Sum(TestPlaneLines(
      {&evidence_, camera_}, Renumber(labels_, {0, 0}), {shared}, model_));
  EXPECT_GT(found.sides[0].area, 0.0);
  EXPECT_EQ(found.sides[0].area, expected.sides[0].area);
}

TEST(LineEvidenceSumTest, AddsUpOverViews) {
  ViewLineEvidence view = {/*first=*/0, /*last=*/1, /*begin=*/0, {{}}, 22.0};
  view.lines[0].sides[0] = {100.0, 2.0, 3.0, 1};
  view.lines[0].sides[1] = {10.0, 20.0, 30.0, 0};
  LineEvidenceSum sum(1);
  sum.Add({view});
  sum.Add({view});
  const LineEvidence found = sum.Get()[0];
  EXPECT_EQ(found.sides[0].area, 200.0);
  EXPECT_EQ(found.sides[0].measured, 4.0);
  EXPECT_EQ(found.sides[0].through, 6.0);
  EXPECT_EQ(found.sides[0].num_views, 2);
  EXPECT_EQ(found.sides[1].through, 60.0);
  EXPECT_EQ(found.sides[1].num_views, 0);
}

TEST(LineEvidenceSumTest, ViewsThatDoNotShowALineTellWhatIsMeasuredBesideIt) {
  // Lines 1 to 5 are of one plane; the view shows line 3.
  const ViewLineEvidence view = {
      /*first=*/1, /*last=*/6, /*begin=*/3, {{}}, 50.0};
  LineEvidenceSum sum(7);
  sum.Add({view});
  const std::vector<LineEvidence> found = sum.Get();
  const double above[] = {0.0, 50.0, 50.0, 0.0, 0.0, 0.0, 0.0};
  const double below[] = {0.0, 0.0, 0.0, 0.0, 50.0, 50.0, 0.0};
  for (size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].sides[0].measured, below[i]) << i;
    EXPECT_EQ(found[i].sides[1].measured, above[i]) << i;
    EXPECT_EQ(found[i].sides[0].num_views + found[i].sides[1].num_views, 0);
  }
}

}  // namespace
}  // namespace tsar
