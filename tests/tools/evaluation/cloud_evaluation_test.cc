// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/cloud_evaluation.h"

#include <limits>
#include <sstream>

#include "tests/support/test_files.h"
#include <Eigen/Geometry>

namespace tsar {
namespace {

using Points = std::vector<Eigen::Vector3d>;

constexpr int kSamples = 200;
constexpr double kStep = 0.002;  // Dense enough for the beams to touch.

// A wall of 0.4 x 0.4 m, 2 m in front of the scanner, in the scanner's frame.
Points Wall() {
  Points points;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      points.emplace_back(2.0,
                          (i - kSamples / 2 + 0.5) * kStep,
                          (j - kSamples / 2 + 0.5) * kStep);
    }
  }
  return points;
}

// The points moved along the rays from the scanner.
Points Scaled(Points points, double factor) {
  for (Eigen::Vector3d& point : points) {
    point *= factor;
  }
  return points;
}

Points Joined(Points a, const Points& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

// The scores of points in the scanner's frame at 1 and 2 cm.
std::vector<CloudScore> Score(const Points& points) {
  Eigen::Isometry3d world_from_scan = Eigen::Isometry3d::Identity();
  world_from_scan.linear() =
      Eigen::AngleAxisd(std::acos(0.0), Eigen::Vector3d::UnitZ())
          .toRotationMatrix();
  world_from_scan.translation() = Eigen::Vector3d(0.3, -0.2, 0.1);
  Points world;
  for (const Eigen::Vector3d& point : points) {
    world.push_back(world_from_scan * point);
  }
  CloudEvaluationOptions options;
  options.tolerances = {0.01, 0.02};
  const CloudEvaluation evaluation =
      EvaluateCloud(world, {{Wall(), world_from_scan.matrix()}}, options);
  EXPECT_EQ(evaluation.num_points, static_cast<int64_t>(points.size()));
  EXPECT_EQ(evaluation.num_scan_points, kSamples * kSamples);
  EXPECT_EQ(evaluation.scores.size(), 2u);
  return evaluation.scores;
}

TEST(EvaluateCloud, TheScanItselfIsPerfect) {
  for (const CloudScore& score : Score(Wall())) {
    EXPECT_DOUBLE_EQ(score.completeness, 1);
    EXPECT_DOUBLE_EQ(score.accuracy, 1);
    EXPECT_DOUBLE_EQ(score.f1, 1);
  }
}

TEST(EvaluateCloud, AWallShiftedBy15MillimetersIsRightAt2Centimeters) {
  const auto scores = Score(Scaled(Wall(), 1 - 0.015 / 2));
  EXPECT_EQ(scores[0].tolerance, 0.01);
  EXPECT_EQ(scores[0].completeness, 0);
  EXPECT_EQ(scores[0].accuracy, 0);
  EXPECT_EQ(scores[0].f1, 0);
  EXPECT_DOUBLE_EQ(scores[1].completeness, 1);
  EXPECT_DOUBLE_EQ(scores[1].accuracy, 1);
}

TEST(EvaluateCloud, HalfAWallIsAccurateAndHalfComplete) {
  Points half;
  for (const Eigen::Vector3d& point : Wall()) {
    if (point.y() < 0) {
      half.push_back(point);
    }
  }
  const auto scores = Score(half);
  // The tolerance reaches 4 columns of points, of 200, into the missing half
  // (the fifth is exactly at the tolerance).
  EXPECT_NEAR(scores[0].completeness, 0.5 + 4.5 / kSamples, 0.01);
  EXPECT_DOUBLE_EQ(scores[0].accuracy, 1);
  EXPECT_NEAR(scores[1].completeness, 0.5 + 9.5 / kSamples, 0.01);
}

TEST(EvaluateCloud, PointsThatBeamsPassedThroughAreWrong) {
  const auto scores = Score(Joined(Wall(), Scaled(Wall(), 0.5)));
  // The wall has 40 x 40 voxels in one grid and 41 x 41 in the other, the
  // floating points 20 x 20 and 21 x 21.
  const double expected = (1600. + 1681.) / (1600. + 1681. + 400. + 441.);
  EXPECT_NEAR(scores[0].accuracy, expected, 1e-9);
  EXPECT_NEAR(scores[1].accuracy, expected, 1e-9);
  EXPECT_DOUBLE_EQ(scores[0].completeness, 1);
}

TEST(EvaluateCloud, PointsBehindTheWallOrBesideTheScanAreNotCounted) {
  Points points = Joined(Wall(), Scaled(Wall(), 1.5));
  points.emplace_back(1, 1, 0);
  points.emplace_back(-2, 0, 0);
  EXPECT_DOUBLE_EQ(Score(points)[0].accuracy, 1);
}

TEST(EvaluateCloud, OneScannerThatSawThroughAPointIsEnough) {
  // The second scanner stands behind the wall and looks away from it.
  const Points hidden = {{3, 0, 0}};
  const PlacedScan first{Wall(), Eigen::Matrix4d::Identity()};
  PlacedScan second{{{5, 0, 0}}, Eigen::Matrix4d::Identity()};
  second.world_from_scan(0, 3) = 2.5;
  const Points points = Joined(Wall(), hidden);
  CloudEvaluationOptions options;
  options.tolerances = {0.01};
  EXPECT_DOUBLE_EQ(EvaluateCloud(points, {first}, options).scores[0].accuracy,
                   1);
  const double with_second =
      EvaluateCloud(points, {first, second}, options).scores[0].accuracy;
  EXPECT_NEAR(with_second, 3281. / 3283., 1e-9);
}

TEST(EvaluateCloud, AnEmptyCloudScoresZero) {
  for (const CloudScore& score : Score({})) {
    EXPECT_EQ(score.completeness, 0);
    EXPECT_EQ(score.accuracy, 0);
    EXPECT_EQ(score.f1, 0);
  }
}

TEST(EvaluateCloud, DoesNotDependOnTheOrderOfPoints) {
  const Points points = Joined(Wall(), Scaled(Wall(), 0.9));
  const Points reversed(points.rbegin(), points.rend());
  EXPECT_EQ(Score(points)[0].accuracy, Score(reversed)[0].accuracy);
}

TEST(EvaluateCloud, RejectsOptionsThatMeanNothing) {
  const auto code_with = [](auto change) {
    CloudEvaluationOptions options;
    change(&options);
    return CodeOf([&] { EvaluateCloud({}, {}, options); });
  };
  using Options = CloudEvaluationOptions;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code_with([](Options* o) { o->tolerances.clear(); }),
            ErrorCode::kBadOption);
  EXPECT_EQ(code_with([](Options* o) { o->voxel_size = 0; }),
            ErrorCode::kBadOption);
  EXPECT_EQ(code_with([&](Options* o) { o->voxel_size = nan; }),
            ErrorCode::kBadOption);
  EXPECT_EQ(code_with([](Options* o) { o->beam.start_radius = -1; }),
            ErrorCode::kBadOption);
  EXPECT_EQ(code_with([](Options* o) { o->beam.divergence_degrees = 90; }),
            ErrorCode::kBadOption);
}

class EvaluateCloudFileTest : public FolderTest {
 protected:
  static std::string Ply(const Points& points) {
    std::ostringstream text;
    text << "ply\nformat ascii 1.0\nelement vertex " << points.size()
         << "\nproperty float x\nproperty float y\nproperty float z\n"
            "end_header\n";
    for (const Eigen::Vector3d& point : points) {
      text << point.transpose() << "\n";
    }
    return text.str();
  }

  void WriteProject() const {
    Write("scans/all.mlp",
          "<MeshLabProject><MeshGroup><MLMesh filename=\"a.ply\"><MLMatrix44>"
          "1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1</MLMatrix44></MLMesh></MeshGroup>"
          "</MeshLabProject>");
  }

  CloudEvaluation Evaluate() const {
    return EvaluateCloudFile(
        folder_ / "cloud.ply", folder_ / "scans" / "all.mlp", {});
  }
};

TEST_F(EvaluateCloudFileTest, PlacesTheScansByTheirPoses) {
  WriteProject();
  Write("scans/a.ply", Ply({{2, 0, 0}}));
  Write("cloud.ply", Ply({{3, 0, 0}}));
  const CloudEvaluation evaluation = Evaluate();
  EXPECT_EQ(evaluation.num_points, 1);
  EXPECT_EQ(evaluation.num_scan_points, 1);
  EXPECT_EQ(evaluation.scores.front().f1, 1);
}

TEST_F(EvaluateCloudFileTest, ScansWithoutPointsAreAnError) {
  WriteProject();
  Write("scans/a.ply", Ply({}));
  Write("cloud.ply", Ply({{3, 0, 0}}));
  EXPECT_EQ(CodeOf([&] { Evaluate(); }), ErrorCode::kMismatch);
}

TEST_F(EvaluateCloudFileTest, AMissingScanIsAnError) {
  WriteProject();
  Write("cloud.ply", Ply({{3, 0, 0}}));
  EXPECT_EQ(CodeOf([&] { Evaluate(); }), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace tsar
