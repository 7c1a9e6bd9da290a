// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/creases/plane_lines.h"

#include "colmap_tsar/scene/creases/shared_lines.h"

#include "tests/scene/creases/drawn_wall_fixture.h"

namespace tsar {
namespace {

class PlaneLinesTest : public DrawnWallTest {
 protected:
  PlaneLinesTest()
      : camera_(CameraAt({0.2, 0.05, 0.0})),
        evidence_(BareEvidence(camera_)),
        labels_(AllOn(0)) {}

  // The lines that five such views share.
  std::vector<PlaneLine> Find() const {
    const std::vector<PlaneProfile> profiles =
        MakePlaneProfiles({&evidence_, camera_}, labels_, model_);
    return FindSharedLines({profiles, profiles, profiles, profiles, profiles});
  }

  // The wall is brighter by `step` from this place on an axis, as a lens shows
  // it: over two pixels.
  void PaintStep(int axis, double place, double step) {
    Paint(
        camera_,
        [&](const Eigen::Vector3d& point) {
          const double share = 0.5 + (point[axis] - place) / (2.0 * kPixel);
          return 100.0 + step * std::clamp(share, 0.0, 1.0);
        },
        &evidence_);
  }

  void AddNoise(double deviation) {
    Philox random(3, 0, 0);
    for (uint8_t& pixel : evidence_.gray) {
      pixel = static_cast<uint8_t>(
          std::lround(pixel + deviation * NextNormal(&random)));
    }
  }

  void ExpectLine(const PlaneLine& line, int axis, double place, double step) {
    EXPECT_EQ(line.plane, 0);
    EXPECT_EQ(line.axis, axis);
    EXPECT_NEAR(line.position, place, 0.5 * kPixel);
    EXPECT_NEAR(line.pixel, kPixel, 0.05 * kPixel);
    EXPECT_NEAR(line.step, step, 0.2 * std::abs(step));
  }

  Camera camera_;
  ViewEvidence evidence_;
  std::vector<int> labels_;
};

TEST_F(PlaneLinesTest, FindsAStepAlongEitherAxisWithItsSign) {
  for (const int axis : {0, 1}) {
    for (const double step : {6.0, -6.0}) {
      for (const double place : {-1.23, -0.41, 0.0, 0.98, 1.317}) {
        SCOPED_TRACE(testing::Message()
                     << "axis " << axis << ", " << step << " at " << place);
        PaintStep(axis, place, step);
        const std::vector<PlaneLine> lines = Find();
        ASSERT_EQ(lines.size(), 1u);
        ExpectLine(lines[0], axis, place, step);
      }
    }
  }
}

TEST_F(PlaneLinesTest, FindsTheLineInANoisyImageAndNoneInNoiseAlone) {
  AddNoise(2.0);
  EXPECT_TRUE(Find().empty());
  PaintStep(1, -0.7, 4.0);
  AddNoise(2.0);
  const std::vector<PlaneLine> lines = Find();
  ASSERT_EQ(lines.size(), 1u);
  ExpectLine(lines[0], 1, -0.7, 4.0);
}

TEST_F(PlaneLinesTest, AWallThatGetsDarkerHasNoLine) {
  Paint(
      camera_,
      [](const Eigen::Vector3d& point) { return 120.0 + 10.0 * point.y(); },
      &evidence_);
  EXPECT_TRUE(Find().empty());
}

TEST_F(PlaneLinesTest, ThePosterOfAFifthOfTheWallHasNone) {
  const auto paint = [&](double half_width) {
    Paint(
        camera_,
        [&](const Eigen::Vector3d& point) {
          return std::abs(point.y()) < 0.4 &&
                         std::abs(point.x() - 0.2) < half_width
                     ? 120.0
                     : 100.0;
        },
        &evidence_);
  };
  // The wall is 6.7 wide.
  paint(0.67);
  EXPECT_TRUE(Find().empty());
  // At most of the wall's width, it is no longer a poster.
  paint(2.7);
  const std::vector<PlaneLine> lines = Find();
  ASSERT_FALSE(lines.empty());
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const PlaneLine& l) {
    return l.axis == 1 && std::abs(l.position - 0.4) < kPixel;
  }));
}

TEST_F(PlaneLinesTest, ALineOutOfTheFrameIsNone) {
  const auto paint = [&](double degrees) {
    const double slope = std::tan(degrees * M_PI / 180.0);
    Paint(
        camera_,
        [&](const Eigen::Vector3d& point) {
          return point.y() > 0.3 + slope * point.x() ? 108.0 : 100.0;
        },
        &evidence_);
  };
  paint(10.0);
  EXPECT_TRUE(Find().empty());
  paint(0.3);
  EXPECT_EQ(Find().size(), 1u);
}

TEST_F(PlaneLinesTest, TheEdgeOfWhatStandsBeforeTheWallIsNone) {
  const int before = AddPlane({0.0, 0.0, -1.0}, {0.0, 0.0, 3.0}, 2, 100.0);
  constexpr int kRow = 40;
  for (int y = 0; y < kRow; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      evidence_.gray(x, y) = 130;
      labels_[SuperpixelAt(x, y)] = before;
    }
  }
  EXPECT_TRUE(Find().empty());
  // It would be one if all of it were the wall.
  labels_ = AllOn(0);
  EXPECT_EQ(Find().size(), 1u);
}

TEST_F(PlaneLinesTest, TheWallMayEndAtTheLineAndNotFarBeforeIt) {
  const double end = OnWall(camera_, 0.0, 39.9).y();
  RelabelAbove(end, camera_, -1, &labels_);
  PaintStep(1, end, 6.0);
  std::vector<PlaneLine> lines = Find();
  ASSERT_EQ(lines.size(), 1u);
  ExpectLine(lines[0], 1, end, 6.0);
  // Ten pixels further up.
  PaintStep(1, end - 10.0 * kPixel, 6.0);
  EXPECT_TRUE(Find().empty());
}

TEST_F(PlaneLinesTest, SmallPlanesAndThoseOfNoFrameHaveNone) {
  PaintStep(1, 0.0, 6.0);
  EXPECT_EQ(Find().size(), 1u);
  // Superpixels at the line, of which four are 2 % of the raster.
  labels_ = AllOn(-1);
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(Find().empty()) << i;
    labels_[5 * kNumColumns + i] = 0;
  }
  EXPECT_FALSE(Find().empty());
  model_.planes[0].axis = -1;
  EXPECT_TRUE(Find().empty());
}

class PlaneCopiesTest : public DrawnWallTest {
 protected:
  // Two cameras, five units in front of the wall, see all planes.
  std::vector<int> Find() const {
    std::vector<int> all;
    for (size_t i = 0; i < model_.planes.size(); ++i) {
      all.push_back(static_cast<int>(i));
    }
    return FindPlaneCopies(
        model_, {CameraAt({0, 0, 0}), CameraAt({0.5, 0, 0})}, {&all, &all});
  }

  int AddWall(double z, double support) {
    return AddPlane({0.0, 0.0, -1.0}, {0.0, 0.0, z}, 2, support);
  }
};

TEST_F(PlaneCopiesTest, PlanesWithinTheToleranceAreOne) {
  AddWall(kDistance + 0.06, 500.0);
  AddWall(kDistance - 0.06, 2000.0);
  AddWall(kDistance + 0.1, 10.0);
  // The third is the best known. Its copies are those close to itself, not to
  // one of these.
  EXPECT_EQ(Find(), (std::vector<int>{2, 1, 2, 1}));
}

TEST_F(PlaneCopiesTest, OtherSurfacesAreNot) {
  // Another component, the back of the wall, another frame, none, and a floor.
  model_.planes[AddWall(kDistance, 1.0)].component = 1;
  AddPlane({0.0, 0.0, 1.0}, {0.0, 0.0, kDistance}, 2, 1.0);
  model_.frames.push_back(Eigen::Matrix3d::Identity());
  model_.planes[AddWall(kDistance, 1.0)].frame = 1;
  model_.planes[AddWall(kDistance, 1.0)].axis = -1;
  AddPlane({0.0, -1.0, 0.0}, {0.0, 0.0, kDistance}, 1, 1.0);
  EXPECT_EQ(Find(), (std::vector<int>{0, 1, 2, 3, 4, 5}));
}

TEST_F(PlaneCopiesTest, WhatNoViewShowsIsNone) {
  AddWall(kDistance, 1.0);
  const std::vector<int> shown = {-1, 0, 0};
  EXPECT_EQ(FindPlaneCopies(model_, {CameraAt({0, 0, 0})}, {&shown}),
            (std::vector<int>{0, 1}));
}

}  // namespace
}  // namespace tsar
