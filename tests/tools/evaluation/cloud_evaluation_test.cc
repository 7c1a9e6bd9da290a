// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/cloud_evaluation.h"

#include "colmap_tsar/tools/evaluation/tolerances.h"

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

TEST(EvaluateCloud, ScoresAWall) {
  Points half;
  for (const Eigen::Vector3d& point : Wall()) {
    if (point.y() < 0) {
      half.push_back(point);
    }
  }
  const Points floating = Joined(Wall(), Scaled(Wall(), 0.5));
  // The wall has 40 x 40 voxels in one grid and 41 x 41 in the other, the
  // floating points 20 x 20 and 21 x 21.
  const double without_floating =
      (1600. + 1681.) / (1600. + 1681. + 400. + 441.);
  const struct {
    const char* name;
    Points points;
    double completeness[2];
    double accuracy[2];
    double max_error;
  } cases[] = {
      {"the scan itself", Wall(), {1, 1}, {1, 1}, 0},
      {"nothing", {}, {0, 0}, {0, 0}, 0},
      {"15 mm too near", Scaled(Wall(), 1 - 0.015 / 2), {0, 1}, {0, 1}, 1e-12},
      // The tolerance reaches 4 columns of points, of 200, into the missing
      // half (the fifth is exactly at the tolerance).
      {"half a wall",
       half,
       {0.5 + 4.5 / kSamples, 0.5 + 9.5 / kSamples},
       {1, 1},
       0.01},
      {"what beams passed through",
       floating,
       {1, 1},
       {without_floating, without_floating},
       1e-9},
      {"in another order",
       Points(floating.rbegin(), floating.rend()),
       {1, 1},
       {without_floating, without_floating},
       1e-9},
      {"behind the wall and beside the scan",
       Joined(Joined(Wall(), Scaled(Wall(), 1.5)), {{1, 1, 0}, {-2, 0, 0}}),
       {1, 1},
       {1, 1},
       1e-12},
  };
  for (const auto& of : cases) {
    SCOPED_TRACE(of.name);
    const std::vector<CloudScore> scores = Score(of.points);
    for (const int t : {0, 1}) {
      EXPECT_EQ(scores[t].tolerance, 0.01 * (t + 1));
      EXPECT_NEAR(scores[t].completeness, of.completeness[t], of.max_error);
      EXPECT_NEAR(scores[t].accuracy, of.accuracy[t], of.max_error);
    }
    EXPECT_EQ(scores[0].f1,
              HarmonicMean(scores[0].completeness, scores[0].accuracy));
  }
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

TEST(EvaluateCloud, RejectsOptionsThatMeanNothing) {
  CloudEvaluationOptions bad[5];
  bad[0].tolerances.clear();
  bad[1].voxel_size = 0;
  bad[2].voxel_size = std::numeric_limits<double>::quiet_NaN();
  bad[3].beam.start_radius = -1;
  bad[4].beam.divergence_degrees = 90;
  for (const CloudEvaluationOptions& options : bad) {
    EXPECT_EQ(CodeOf([&] { EvaluateCloud({}, {}, options); }),
              ErrorCode::kBadOption);
  }
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

  CloudEvaluation Evaluate() const {
    return EvaluateCloudFile(
        folder_ / "cloud.ply", folder_ / "scans" / "all.mlp", {});
  }
};

TEST_F(EvaluateCloudFileTest, PlacesTheScansByTheirPoses) {
  Write("scans/all.mlp",
        "<MeshLabProject><MeshGroup><MLMesh filename=\"a.ply\"><MLMatrix44>"
        "1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1</MLMatrix44></MLMesh></MeshGroup>"
        "</MeshLabProject>");
  Write("cloud.ply", Ply({{3, 0, 0}}));
  EXPECT_EQ(CodeOf([&] { Evaluate(); }), ErrorCode::kNotFound);
  Write("scans/a.ply", Ply({}));
  EXPECT_EQ(CodeOf([&] { Evaluate(); }), ErrorCode::kMismatch);
  Write("scans/a.ply", Ply({{2, 0, 0}}));
  const CloudEvaluation evaluation = Evaluate();
  EXPECT_EQ(evaluation.num_points, 1);
  EXPECT_EQ(evaluation.num_scan_points, 1);
  EXPECT_EQ(evaluation.scores.front().f1, 1);
}

}  // namespace
}  // namespace tsar
