// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/seen_cylinders.h"

#include <cmath>
#include <utility>

#include "tests/support/drawn_column.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

ModelCylinder ColumnInModel() {
  const DrawnColumn column;
  ModelCylinder cylinder;
  cylinder.point = {column.center.x(), column.center.y(), 0.0};
  cylinder.radius = column.radius;
  cylinder.min_height = column.bottom;
  cylinder.max_height = column.top;
  return cylinder;
}

// From where to where above its bottom it is seen; all of it between them.
std::pair<float, float> SeenHeights(const SeenCylinder& seen) {
  int begin = 0;
  int end = SeenCylinder::kNumBins;
  while (begin < end && seen.is_seen[begin] == 0) {
    ++begin;
  }
  while (begin < end && seen.is_seen[end - 1] == 0) {
    --end;
  }
  for (int bin = begin; bin < end; ++bin) {
    EXPECT_EQ(seen.is_seen[bin], 1) << bin;
  }
  const float size = seen.length / SeenCylinder::kNumBins;
  return {begin * size, end * size};
}

TEST(SeenCylindersTest, ShowsAllOfItWhereNothingHidesIt) {
  const DrawnViews drawn(DrawnColumn(), 4);
  for (const ObservedView& view : drawn.Views()) {
    const std::vector<SeenCylinder> seen =
        FindSeenCylinders(view, {ColumnInModel()});
    ASSERT_EQ(seen.size(), 1u);
    const auto [begin, end] = SeenHeights(seen[0]);
    EXPECT_NEAR(begin, 0.f, 0.06f);
    EXPECT_NEAR(end, 1.3f, 0.06f);
    EXPECT_TRUE(seen[0].IsSeenAt(0.6f));
    EXPECT_FALSE(seen[0].IsSeenAt(-0.01f));
    EXPECT_FALSE(seen[0].IsSeenAt(1.31f));
    EXPECT_FALSE(seen[0].IsSeenAt(NAN));
  }
}

TEST(SeenCylindersTest, EndsWhereSomethingHidesIt) {
  // A wide bare thing in the way, of the column's own brightness, up to 0.1.
  const DrawnScene scene = [](const Eigen::Vector3d& from,
                              const Eigen::Vector3d& direction) {
    const double distance = (1.5 - from.y()) / direction.y();
    return from.z() + distance * direction.z() < 0.1
               ? DrawnColumn::kColumn
               : DrawnColumn()(from, direction);
  };
  const DrawnViews drawn(scene, 4);
  for (const ObservedView& view : drawn.Views()) {
    const std::vector<SeenCylinder> seen =
        FindSeenCylinders(view, {ColumnInModel()});
    ASSERT_EQ(seen.size(), 1u);
    // At the column's distance the thing ends elsewhere than at its own.
    const Eigen::Vector3d from = view.camera.Center();
    const double share = (2.75 - from.y()) / (1.5 - from.y());
    const double hidden = from.z() + share * (0.1 - from.z());
    const auto [begin, end] = SeenHeights(seen[0]);
    EXPECT_NEAR(begin, hidden - DrawnColumn().bottom, 0.08);
    EXPECT_NEAR(end, 1.3f, 0.06f);
  }
}

TEST(SeenCylindersTest, NeedsOnlyTheOutlinesWithinTheImage) {
  // The first view shows its right outline alone.
  DrawnColumn column;
  column.center.x() = -1.6;
  column.radius = 0.35;
  ModelCylinder cylinder = ColumnInModel();
  cylinder.point.x() = column.center.x();
  cylinder.radius = column.radius;
  const DrawnViews drawn(column, 5);
  const std::vector<SeenCylinder> seen =
      FindSeenCylinders(drawn.Views()[0], {cylinder});
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_TRUE(seen[0].IsSeenAt(0.6f));
}

TEST(SeenCylindersTest, ShowsNothingWithoutOutlines) {
  const DrawnViews empty([](const auto&, const auto&) { return 90.0; }, 4);
  const DrawnViews drawn(DrawnColumn(), 4);
  ModelCylinder elsewhere = ColumnInModel();
  elsewhere.point.x() += 0.1;
  ModelCylinder behind = ColumnInModel();
  behind.point.y() = -5.0;
  for (size_t view = 0; view < 4; ++view) {
    EXPECT_TRUE(
        FindSeenCylinders(empty.Views()[view], {ColumnInModel()}).empty());
    EXPECT_TRUE(
        FindSeenCylinders(drawn.Views()[view], {elsewhere, behind}).empty());
    EXPECT_TRUE(FindSeenCylinders(drawn.Views()[view], {}).empty());
  }
}

// Compared with differences of the depth itself.
TEST(SeenCylindersTest, KnowsHowItsErrorsMoveDepths) {
  const DrawnViews drawn(DrawnColumn(), 4);
  const Camera& camera = drawn.Views()[1].camera;
  ModelCylinder cylinder = ColumnInModel();
  Eigen::Matrix3d root;
  root << 1e-3, 0, 0, 4e-4, 8e-4, 0, -3e-4, 2e-4, 5e-4;
  cylinder.covariance = root * root.transpose();
  const SeenCylinder seen = ToCameraCylinder(cylinder, camera);
  for (const float offset : {-0.05f, 0.f, 0.04f}) {
    const Vec3f middle = seen.cylinder.point * (1.f / seen.cylinder.point.z);
    const Vec3f ray = {middle.x + offset, 0.01f, 1.f};
    Cylinder::Intersection intersection;
    ASSERT_TRUE(seen.cylinder.Intersect(ray, &intersection));
    double variance = 0.0;
    for (int i = 0; i < 3; ++i) {
      ModelCylinder moved = cylinder;
      moved.point += root(0, i) * cylinder.frame.across +
                     root(1, i) * cylinder.frame.Third();
      moved.radius += root(2, i);
      Cylinder::Intersection other;
      ASSERT_TRUE(
          ToCameraCylinder(moved, camera).cylinder.Intersect(ray, &other));
      variance += (other.depth - intersection.depth) *
                  (other.depth - intersection.depth);
    }
    EXPECT_NEAR(std::sqrt(seen.DepthVariance(ray, intersection.normal)),
                std::sqrt(variance),
                0.03 * std::sqrt(variance));
  }
}

}  // namespace
}  // namespace tsar
