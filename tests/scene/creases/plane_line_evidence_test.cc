// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

// What views reveal about lines, before any of them is a crease.

#include "colmap_tsar/scene/creases/line_evidence.h"

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

  LineEvidence Test() const {
    const PlaneLine line = {
        0, 1, static_cast<float>(kLine), static_cast<float>(kPixel), 3.f, 3};
    return TestPlaneLines({&evidence_, camera_}, labels_, {line}, model_)[0];
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
  // Except for three pixels next to the line.
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
  // On the ceiling, and in front of it.
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

TEST_F(PlaneLineEvidenceTest, AreasOfOtherPlanesDoNotCount) {
  const int other = AddPlane({0.0, 1.0, 0.0}, {0.0, kLine, 4.0}, 1, 100.0);
  RelabelAbove(kLine + 0.5, camera_, other, &labels_);
  LineEvidence found = Test();
  EXPECT_EQ(found.sides[0].area, 0.0);
  EXPECT_EQ(found.sides[0].num_views, 0);
  // Areas of no plane do.
  RelabelAbove(kLine + 0.5, camera_, -1, &labels_);
  EXPECT_GT(Test().sides[0].area, 0.8 * (PixelsAbove() - 3 * kWidth));
}

TEST_F(PlaneLineEvidenceTest, AViewWithoutThePlaneTellsNothing) {
  MeasureSides(1.0, 1.0);
  labels_ = AllOn(-1);
  const LineEvidence found = Test();
  for (const LineEvidence::Side& side : found.sides) {
    EXPECT_EQ(side.area + side.measured + side.through, 0.0);
    EXPECT_EQ(side.num_views, 0);
  }
}

// What is measured on the plane lies above the lines far below it, and below
// those far above it.
TEST_F(PlaneLineEvidenceTest, ViewsTellAboutLinesFarFromWhatTheyShow) {
  MeasureSides(1.0, 1.0);
  const auto pixel = static_cast<float>(kPixel);
  const std::vector<PlaneLine> lines = {{0, 1, -50.f, pixel, 3.f, 3},
                                        {0, 1, 0.f, pixel, 3.f, 3},
                                        {0, 1, 50.f, pixel, 3.f, 3}};
  const std::vector<LineEvidence> found =
      TestPlaneLines({&evidence_, camera_}, labels_, lines, model_);
  std::vector<LineEvidence> sum = found;
  AddEvidence(found, &sum);
  const double all = 0.5 * kWidth * kHeight;
  EXPECT_NEAR(sum[0].sides[1].measured, 2.0 * all, 0.01 * all);
  EXPECT_NEAR(sum[2].sides[0].measured, 2.0 * all, 0.01 * all);
  for (const size_t i : {0, 2}) {
    EXPECT_EQ(sum[i].sides[i / 2].measured, 0.0);
    EXPECT_EQ(sum[i].sides[0].num_views + sum[i].sides[1].num_views, 0);
  }
  EXPECT_GT(sum[1].sides[0].measured, 0.2 * all);
  EXPECT_EQ(sum[1].sides[0].area, 2.0 * found[1].sides[0].area);
}

}  // namespace
}  // namespace tsar
