// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/cylinders.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/drawn_column.h"
#include "tests/support/scene_model_testing.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tsar {
namespace {

const Eigen::Matrix3d kUpright = Eigen::Matrix3d::Identity();

// A wall behind everything.
std::vector<ModelPlane> WallBehind() {
  return {MakeModelPlane({0.0, -1.0, 0.0}, {0.0, 3.5, 0.0})};
}

// Superpixels that nobody measured.
const ViewLabels kUnlabeled = {
    {-1}, {LabelOrigin::kNone}, std::vector<LabelQuality>(1)};

std::vector<ModelCylinder> Find(
    const DrawnViews& drawn,
    const std::vector<Eigen::Matrix3d>& frames = {kUpright},
    const ViewLabels& labels = kUnlabeled) {
  ThreadPool threads(2);
  const std::vector<std::vector<size_t>> neighbors = drawn.Neighbors();
  CylinderSearch search(frames, neighbors);
  EXPECT_EQ(search.NumAxes(), 3 * frames.size());
  for (size_t view = 0; view < drawn.Views().size(); ++view) {
    search.FindOutlines(view, drawn.Views()[view]);
  }
  for (size_t axis = 0; axis < search.NumAxes(); ++axis) {
    search.FindCircles(axis, threads);
  }
  for (const ObservedView& view : drawn.Views()) {
    search.Test(view, WallBehind(), labels);
  }
  EXPECT_TRUE(search.HasFoundAny() || search.Result().empty());
  return search.Result();
}

// rotation: of the scene, whose plane z = 0 the axis meets at the column's
// center.
void ExpectColumn(const std::vector<ModelCylinder>& found,
                  const Eigen::Matrix3d& rotation,
                  double tolerance) {
  const DrawnColumn column;
  ASSERT_EQ(found.size(), 1u);
  const ModelCylinder& cylinder = found[0];
  EXPECT_NEAR(cylinder.radius, column.radius, tolerance);
  EXPECT_NEAR(
      std::abs(cylinder.frame.along.dot(rotation * Eigen::Vector3d::UnitZ())),
      1.0,
      1e-9);
  const Eigen::Vector3d point = rotation.transpose() * cylinder.point;
  EXPECT_NEAR(point.x(), column.center.x(), tolerance);
  EXPECT_NEAR(point.y(), column.center.y(), tolerance);
  const double sign =
      cylinder.frame.along.dot(rotation * Eigen::Vector3d::UnitZ());
  const double bottom = point.z() + sign * cylinder.min_height;
  const double top = point.z() + sign * cylinder.max_height;
  EXPECT_NEAR(std::min(bottom, top), column.bottom, 0.06);
  EXPECT_NEAR(std::max(bottom, top), column.top, 0.06);
  // At most the error caused by a third of a pixel.
  const double pixel = 3.0 / DrawnViews::kFocal;
  EXPECT_GT(cylinder.covariance(2, 2), 0.0);
  EXPECT_LT(std::sqrt(cylinder.covariance(2, 2)), 0.33 * pixel);
}

// The brighter of two drawings.
DrawnScene Both(const DrawnColumn& a, const DrawnColumn& b) {
  return [=](const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
    return std::max(a(from, direction), b(from, direction));
  };
}

// From the lower to the upper.
void SortByHeight(std::vector<ModelCylinder>* cylinders) {
  // Heights are along either of the two directions of the axis.
  const auto height = [](const ModelCylinder& cylinder) {
    return cylinder.frame.along.z() *
           (cylinder.min_height + cylinder.max_height);
  };
  std::sort(
      cylinders->begin(), cylinders->end(), [&](const auto& a, const auto& b) {
        return height(a) < height(b);
      });
}

TEST(CylindersTest, FindsABareColumn) {
  const DrawnViews drawn(DrawnColumn(), 7);
  ExpectColumn(Find(drawn), kUpright, 0.002);
}

TEST(CylindersTest, FindsItInNoise) {
  const DrawnViews drawn(DrawnColumn(), 7, kUpright, 4.0);
  ExpectColumn(Find(drawn), kUpright, 0.006);
}

// Any axis of any of the frames, whatever the world's directions are.
TEST(CylindersTest, FindsItInATurnedWorld) {
  const Eigen::Matrix3d turned =
      Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, -2, 0.5).normalized())
          .toRotationMatrix();
  const Eigen::Matrix3d other_order =
      Eigen::AngleAxisd(std::acos(-1.0) / 2.0, Eigen::Vector3d::UnitX())
          .toRotationMatrix();
  const Eigen::Matrix3d oblique =
      Eigen::AngleAxisd(0.6, Eigen::Vector3d(1, 1, 0).normalized())
          .toRotationMatrix();
  const DrawnViews drawn(DrawnColumn(), 7, turned);
  ExpectColumn(
      Find(drawn, {turned * oblique, turned * other_order}), turned, 0.002);
  EXPECT_TRUE(Find(drawn, {turned * oblique}).empty());
  EXPECT_TRUE(Find(drawn, {}).empty());
}

TEST(CylindersTest, FindsItInAnyUnit) {
  for (const double scale : {1e-6, 1e6}) {
    SCOPED_TRACE(scale);
    const std::vector<ModelCylinder> found =
        Find(DrawnViews(DrawnColumn(), 7, kUpright, 0.0, scale));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].radius / scale, 0.25, 0.002);
    EXPECT_NEAR(found[0].min_height / scale, DrawnColumn().bottom, 0.06);
    EXPECT_NEAR(found[0].max_height / scale, DrawnColumn().top, 0.06);
    EXPECT_GT(std::sqrt(found[0].covariance(2, 2)) / scale, 1e-5);
    EXPECT_LT(std::sqrt(found[0].covariance(2, 2)) / scale, 0.005);
  }
}

TEST(CylindersTest, NeedsFourViews) {
  EXPECT_EQ(Find(DrawnViews(DrawnColumn(), 4)).size(), 1u);
  EXPECT_TRUE(Find(DrawnViews(DrawnColumn(), 3)).empty());
}

TEST(CylindersTest, TakesNoBoardOrSquarePillarForAColumn) {
  const DrawnWalls board = {{{-0.2, 3.1}, {0.3, 2.9}}};
  const DrawnWalls pillar = {
      {{-0.2, 2.8}, {0.2, 2.8}, {0.2, 3.2}, {-0.2, 3.2}, {-0.2, 2.8}}};
  for (const DrawnWalls& walls : {board, pillar}) {
    EXPECT_TRUE(Find(DrawnViews(walls, 7)).empty());
  }
}

TEST(CylindersTest, FindsTheBaseOfAColumnAndItsShaft) {
  DrawnColumn base;
  base.radius = 0.35;
  base.top = -0.1;
  DrawnColumn shaft;
  shaft.bottom = base.top;
  shaft.top = 0.8;
  std::vector<ModelCylinder> found = Find(DrawnViews(Both(base, shaft), 7));
  ASSERT_EQ(found.size(), 2u);
  SortByHeight(&found);
  EXPECT_NEAR(found[0].radius, 0.35, 0.003);
  EXPECT_NEAR(found[0].max_height - found[0].min_height, 0.5, 0.08);
  EXPECT_NEAR(found[1].radius, 0.25, 0.003);
  EXPECT_NEAR(found[1].max_height - found[1].min_height, 0.9, 0.08);
}

// Views that measured surfaces behind it, over all of its area.
TEST(CylindersTest, DropsWhatIsSeenThrough) {
  DrawnViews drawn(DrawnColumn(), 7);
  const auto set_depths = [&](float depth, int step) {
    for (size_t view = 0; view < 7; ++view) {
      Image<float>& depths = drawn.Evidence(view).confident_depth;
      for (int y = 0; y < depths.Height(); ++y) {
        for (int x = y % step; x < depths.Width(); x += step) {
          depths(x, y) = depth;
        }
      }
    }
  };
  // A few depths there are wrong.
  set_depths(5.f, 8);
  EXPECT_EQ(Find(drawn).size(), 1u);
  set_depths(5.f, 2);
  EXPECT_TRUE(Find(drawn).empty());
  // An occluder in front of everything.
  set_depths(1.f, 1);
  EXPECT_EQ(Find(drawn).size(), 1u);
}

// Where views measured a plane between the outlines, these belong to something
// else, such as windows next to a wall.
TEST(CylindersTest, DropsWhatWasMeasuredOnAPlane) {
  const DrawnViews drawn(DrawnColumn(), 7);
  ViewLabels labels = {
      {0}, {LabelOrigin::kMeasured}, std::vector<LabelQuality>(1)};
  EXPECT_TRUE(Find(drawn, {kUpright}, labels).empty());
  labels.origins = {LabelOrigin::kCarried};
  EXPECT_EQ(Find(drawn, {kUpright}, labels).size(), 1u);
}

// Upright, two units in front of the camera, of radius one half.
CameraCylinder UprightCylinder() {
  CameraCylinder cylinder;
  cylinder.point = {0.f, 1.f, 2.f};
  cylinder.axis = {0.f, -1.f, 0.f};
  cylinder.radius = 0.5f;
  cylinder.length = 2.f;
  return cylinder;
}

TEST(CameraCylinderTest, RaysMeetItsFront) {
  CameraCylinder cylinder = UprightCylinder();
  cylinder.axis = Normalized({0.3f, -1.f, -0.4f});
  int num_hits = 0;
  for (float x = -0.5f; x < 0.5f; x += 0.01f) {
    const Vec3f ray = {x, 0.1f, 1.f};
    CameraCylinder::Intersection at;
    if (!cylinder.Intersect(ray, &at)) {
      continue;
    }
    ++num_hits;
    const Vec3f from_begin = ray * at.depth - cylinder.point;
    const float height = Dot(from_begin, cylinder.axis);
    EXPECT_GE(height, 0.f);
    EXPECT_LT(height, cylinder.length);
    const Vec3f from_axis = from_begin - cylinder.axis * height;
    EXPECT_NEAR(Norm(at.normal * cylinder.radius - from_axis), 0.f, 1e-4f);
    EXPECT_LE(Dot(at.normal, ray), 0.f);
  }
  EXPECT_GT(num_hits, 20);
}

TEST(CameraCylinderTest, RaysBesideBeyondWithinAndBehindMissIt) {
  CameraCylinder::Intersection at;
  const auto meets = [&](const Vec3f& point, const Vec3f& ray) {
    CameraCylinder cylinder = UprightCylinder();
    cylinder.point = point;
    return cylinder.Intersect(ray, &at);
  };
  // The outline of a circle of radius one half at a distance of 2.
  const float outline = 0.5f / std::sqrt(4.f - 0.25f);
  EXPECT_TRUE(meets({0.f, 1.f, 2.f}, {0.999f * outline, 0.f, 1.f}));
  EXPECT_FALSE(meets({0.f, 1.f, 2.f}, {1.001f * outline, 0.f, 1.f}));
  EXPECT_FALSE(meets({0.f, 1.f, 2.f}, {0.f, 0.7f, 1.f}));
  EXPECT_FALSE(meets({0.f, 1.f, 2.f}, {0.f, -0.7f, 1.f}));
  EXPECT_FALSE(meets({0.f, 1.f, 0.3f}, {0.f, 0.f, 1.f}));
  EXPECT_FALSE(meets({0.f, 1.f, -2.f}, {0.f, 0.f, 1.f}));
}

// Compared with differences of the depth itself.
TEST(CameraCylinderTest, KnowsHowItsErrorsMoveDepths) {
  ModelCylinder model;
  model.frame = {-Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitX()};
  model.point = {0.1, 0.0, 3.0};
  model.radius = 0.25;
  model.min_height = -1.0;
  model.max_height = 1.0;
  Eigen::Matrix3d root;
  root << 1e-3, 0, 0, 4e-4, 8e-4, 0, -3e-4, 2e-4, 5e-4;
  model.covariance = root * root.transpose();
  const auto intersect = [](const ModelCylinder& cylinder,
                            const Vec3f& ray,
                            CameraCylinder::Intersection* at) {
    const CameraCylinder in_camera = ToCameraCylinders({cylinder}, Camera())[0];
    EXPECT_TRUE(in_camera.Intersect(ray, at));
    return in_camera.DepthVariance(ray, at->normal);
  };
  for (const float offset : {-0.05f, 0.f, 0.04f}) {
    const Vec3f ray = {0.1f / 3.f + offset, 0.01f, 1.f};
    CameraCylinder::Intersection at;
    const float found = intersect(model, ray, &at);
    double variance = 0.0;
    for (int i = 0; i < 3; ++i) {
      ModelCylinder moved = model;
      moved.point +=
          root(0, i) * model.frame.across + root(1, i) * model.frame.Third();
      moved.radius += root(2, i);
      CameraCylinder::Intersection other;
      intersect(moved, ray, &other);
      variance += std::pow(other.depth - at.depth, 2);
    }
    EXPECT_NEAR(
        std::sqrt(found), std::sqrt(variance), 0.03 * std::sqrt(variance));
  }
}

}  // namespace
}  // namespace tsar
