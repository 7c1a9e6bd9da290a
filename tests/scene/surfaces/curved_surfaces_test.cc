// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/curved_surfaces.h"

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <algorithm>
#include <vector>

#include "tests/scene/surfaces/curved_surfaces_fixture.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(CurvedSurfacesTest, ACylinderReplacesItsFacets) {
  const Shape shape = [](const Vec3f& ray) { return Round(10.f, ray, false); };
  Measure(shape);
  MakeFacets(kFacet, kNumRows);
  const CurvedView view = Find();
  ASSERT_EQ(view.surfaces.size(), 1u);
  EXPECT_EQ(CountCurved(view), kNumSuperpixels);
  ExpectShape(view, shape, 3.f);
  EXPECT_EQ(
      std::count(
          view.evidence.begin(), view.evidence.end(), LabelEvidence::kMeasured),
      kNumSuperpixels);
}

TEST_F(CurvedSurfacesTest, ASphereReplacesItsFacets) {
  const Shape shape = [](const Vec3f& ray) { return Round(10.f, ray, true); };
  Measure(shape);
  MakeFacets();
  const CurvedView view = Find();
  ASSERT_EQ(view.surfaces.size(), 1u);
  EXPECT_EQ(CountCurved(view), kNumSuperpixels);
  ExpectShape(view, shape, 3.f);
}

TEST_F(CurvedSurfacesTest, ABowedWallIsFoundWhereThereWasNoPlane) {
  const Shape shape = [](const Vec3f& ray) { return Round(10.f, ray, false); };
  Measure(shape, 0.2);
  const CurvedView view = Find();
  ASSERT_EQ(view.surfaces.size(), 1u);
  EXPECT_EQ(CountCurved(view), kNumSuperpixels);
  ExpectShape(view, shape, 2.f);
}

TEST_F(CurvedSurfacesTest, FillsWhatMeasurementsSurround) {
  const Shape shape = [](const Vec3f& ray) { return Round(10.f, ray, false); };
  Measure(shape);
  Clear(6, 4, 9, 7);
  const int inside = 5 * kNumColumns + 7;
  const CurvedView view = Find();
  ASSERT_EQ(view.surfaces.size(), 1u);
  EXPECT_EQ(CountCurved(view), kNumSuperpixels);
  ExpectShape(view, shape, 3.f);
  EXPECT_EQ(view.evidence[inside], LabelEvidence::kGuessed);
  EXPECT_EQ(view.evidence[0], LabelEvidence::kMeasured);
}

TEST_F(CurvedSurfacesTest, OtherViewsCarryWhatTheySawToo) {
  const Shape shape = [](const Vec3f& ray) { return Round(40.f, ray, false); };
  Measure(shape);
  Clear(6, 4, 9, 7);
  source_depth_ = 4.f;
  EXPECT_EQ(Find().evidence[5 * kNumColumns + 7], LabelEvidence::kCarried);
}

TEST_F(CurvedSurfacesTest, DoesNotDependOnTheUnit) {
  Measure([](const Vec3f& ray) {
    return ray.x < 0.2f ? Round(10.f, ray, false) : 6.f;
  });
  MakeFacets();
  Clear(3, 4, 6, 7);
  const CurvedView expected = Find();
  ASSERT_FALSE(expected.surfaces.empty());
  const EvidenceInputs inputs = inputs_;
  const std::vector<Plane> planes = labeled_.planes;
  // Powers of two, so that not even rounding differs; about 1000 and 0.001.
  for (const float unit : {1024.f, 1.f / 1024.f}) {
    inputs_ = inputs;
    inputs_.resolution.error_per_depth /= unit;
    for (RayDepth& sample : inputs_.samples) {
      sample.z *= unit;
    }
    labeled_.planes = planes;
    for (Plane& plane : labeled_.planes) {
      plane.offset *= unit;
    }
    const CurvedView view = Find();
    EXPECT_EQ(view.labels, expected.labels);
    EXPECT_EQ(view.evidence, expected.evidence);
    const Vec3f ray = inputs_.intrinsics.Ray(20.f, 30.f);
    EXPECT_NEAR(view.surfaces[0].TangentAt(ray).Depth(ray) / unit,
                expected.surfaces[0].TangentAt(ray).Depth(ray),
                1e-4f);
  }
}

TEST_F(CurvedSurfacesTest, FindsTheSameAgain) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, true); }, 0.3);
  MakeFacets();
  const CurvedView first = Find();
  const CurvedView second = Find();
  ASSERT_FALSE(first.surfaces.empty());
  EXPECT_EQ(first.labels, second.labels);
  ASSERT_EQ(first.surfaces.size(), second.surfaces.size());
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(first.surfaces[0].coefficients[i],
              second.surfaces[0].coefficients[i]);
  }
}

TEST_F(CurvedSurfacesTest, TakesAViewWithoutSuperpixels) {
  inputs_ = EvidenceInputs{};
  labeled_ = LabeledView{};
  EXPECT_TRUE(Find().labels.empty());
}

}  // namespace
}  // namespace tsar
