// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/tools/evaluation/cloud_evaluation.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace tsar {
namespace {

const std::vector<double> kTolerances = {0.01, 0.05};
constexpr int kNone = 2;

void ExpectVerdict(const PointVerdict& verdict, int first_good, bool bad) {
  EXPECT_EQ(verdict.first_good, first_good);
  EXPECT_EQ(verdict.bad_below, bad);
}

TEST(LaserScan, KnowsWhatItsBeamsTell) {
  const struct {
    Eigen::Vector3d point;
    int first_good;
    bool is_bad;
  } cases[] = {
      {{1, 0, 0}, kNone, true},
      {{1.97, 0, 0}, 1, true},
      {{1.995, 0, 0}, 0, true},
      {{2.005, 0, 0}, 0, false},
      {{2.03, 0, 0}, 1, false},
      {{3, 0, 0}, kNone, false},
      // Outside of the beam.
      {{1, 0.01, 0}, kNone, false},
      {{-1, 0, 0}, kNone, false},
      // Near the surface, but no beam passed there.
      {{2, 0.004, 0}, kNone, false},
  };
  const LaserScan scan({{2, 0, 0}}, LaserBeam());
  const LaserScan nothing({}, LaserBeam());
  for (const auto& [point, first_good, is_bad] : cases) {
    SCOPED_TRACE(point.transpose());
    ExpectVerdict(scan.Judge(point, kTolerances), first_good, is_bad);
    ExpectVerdict(nothing.Judge(point, kTolerances), kNone, false);
  }
}

TEST(LaserScan, BeamsWidenWithTheDistance) {
  const LaserBeam beam{0.001, 0.1};
  const LaserScan scan({{20, 0, 0}}, beam);
  const double radius = 0.001 + 10 * std::tan(0.1 * std::numbers::pi / 180);
  ExpectVerdict(scan.Judge({10, 0.99 * radius, 0}, kTolerances), kNone, true);
  ExpectVerdict(scan.Judge({10, 1.01 * radius, 0}, kTolerances), kNone, false);
  ExpectVerdict(scan.Judge({1, 0.99 * radius, 0}, kTolerances), kNone, false);
}

// The search through cells finds the same beams as looking at all of them.
TEST(LaserScan, AgreesWithAnExhaustiveSearch) {
  Philox random(7, 0, 0);
  const auto draw_direction = [&]() -> Eigen::Vector3d {
    Eigen::Vector3d direction;
    do {
      direction = {2.0 * random.NextFloat() - 1,
                   2.0 * random.NextFloat() - 1,
                   2.0 * random.NextFloat() - 1};
    } while (direction.norm() > 1 || direction.norm() < 0.1);
    return direction.normalized();
  };
  std::vector<Eigen::Vector3d> points = {
      {0, 0, 3}, {0, 0, -3}, {3, 0, 0}, {-3, 0, 0}};
  for (int i = 0; i < 2000; ++i) {
    points.push_back(draw_direction() * (0.5 + 4 * random.NextFloat()));
  }
  const LaserBeam beam{0.01, 0.3};
  const LaserScan scan(points, beam);

  int num_good = 0;
  int num_bad = 0;
  int num_unknown = 0;
  for (int i = 0; i < 4000; ++i) {
    // Every tenth point is close to the scanner, where beams fill all space.
    const double range = (i % 10 == 0 ? 0.15 : 5.0) * random.NextFloat();
    const Eigen::Vector3d near_beam =
        points[random.NextBelow(2004)] + 0.03 * draw_direction();
    const Eigen::Vector3d point =
        i % 2 == 0 ? draw_direction() * range : near_beam;
    PointVerdict expected{kNone, false};
    const double radius =
        0.01 + point.norm() * std::tan(0.3 * std::numbers::pi / 180);
    for (const Eigen::Vector3d& end : points) {
      const Eigen::Vector3d direction = end.normalized();
      const double along = direction.dot(point);
      if (along < 0 || direction.cross(point).norm() > radius) {
        continue;
      }
      const double distance = (point - end).norm();
      for (int t = 0; t < kNone; ++t) {
        if (distance <= kTolerances[t] && t < expected.first_good) {
          expected.first_good = t;
        }
      }
      expected.bad_below |= along < end.norm();
    }
    ExpectVerdict(scan.Judge(point, kTolerances),
                  expected.first_good,
                  expected.bad_below);
    num_good += expected.first_good < kNone;
    num_bad += expected.first_good == kNone && expected.bad_below;
    num_unknown += expected.first_good == kNone && !expected.bad_below;
  }
  EXPECT_GT(num_good, 200);
  EXPECT_GT(num_bad, 200);
  EXPECT_GT(num_unknown, 200);
}

constexpr PointVerdict kGood{0, true};
constexpr PointVerdict kBad{1, true};
constexpr PointVerdict kUncounted{1, false};

TEST(VoxelMeans, AreSharesOfVoxels) {
  const Eigen::Vector3d here(0.3, 0.3, 0.3);
  const Eigen::Vector3d far(-9.7, 0.3, 0.3);
  const Eigen::Vector3d left(0.2, 0.1, 0.1);
  const Eigen::Vector3d right(0.8, 0.1, 0.1);
  const struct {
    const char* name;
    std::vector<Eigen::Vector3d> points;
    std::vector<PointVerdict> verdicts;
    std::vector<double> means;  // One for each tolerance.
  } cases[] = {
      {"voxels weigh alike",
       {here, far, far, far},
       {kGood, kBad, kBad, kBad},
       {0.5}},
      {"within a voxel",
       {here, here, here, here},
       {kGood, kBad, kBad, kBad},
       {0.25}},
      {"one voxel in the first grid, two in the one shifted by half a voxel",
       {left, left, right},
       {kGood, kGood, kBad},
       {(2.0 / 3 + 1 + 0) / 3}},
      {"not counted", {here, here, far}, {kGood, kUncounted, kUncounted}, {1}},
      {"none counted", {here}, {kUncounted}, {0}},
      {"no points", {}, {}, {0, 0}},
      {"by the tolerances", {here}, {{1, true}}, {0, 1, 1}},
      {"far away", {{1e300, -1e300, 0}, here}, {kGood, kBad}, {0.5}},
  };
  for (const auto& [name, points, verdicts, means] : cases) {
    SCOPED_TRACE(name);
    const std::vector<double> found =
        VoxelMeans(points, verdicts, static_cast<int>(means.size()), 1.0);
    ASSERT_EQ(found.size(), means.size());
    for (size_t t = 0; t < means.size(); ++t) {
      EXPECT_DOUBLE_EQ(found[t], means[t]);
    }
  }
}

}  // namespace
}  // namespace tsar
