// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/curved_surfaces.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/scene_planes/gather_evidence.h"
#include "colmap_tsar/scene_planes/put_curved_surfaces.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "tests/support/drawn_observations.h"
#include "tests/support/drawn_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr int kSize = 10;  // Of a superpixel.
constexpr int kNumColumns = kWidth / kSize;
constexpr int kNumRows = kHeight / kSize;
constexpr int kNumSuperpixels = kNumColumns * kNumRows;
// Superpixels of a facet from left to right.
constexpr int kFacet = 8;
// At a depth of 4 one pixel of disparity is 0.016.
constexpr float kErrorPerDepth = 0.001f;
constexpr float kPixel = 0.016f;

// The depth of a ray on a sphere or upright cylinder with its nearest point at
// 4 on the optical axis.
float Round(float radius, const Vec3f& ray, bool is_sphere) {
  const float middle = 4.f + radius;
  const float a = ray.x * ray.x + (is_sphere ? ray.y * ray.y : 0.f) + 1.f;
  const float root = middle * middle - a * (middle * middle - radius * radius);
  return root > 0.f ? (middle - std::sqrt(root)) / a : 0.f;
}

using Shape = std::function<float(const Vec3f& ray)>;

// Square superpixels, numbered row by row, that see a shape.
class CurvedSurfacesTest : public testing::Test {
 protected:
  CurvedSurfacesTest() : camera_(DrawnCamera(kWidth, kHeight, 160.0)) {
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
    inputs_.resolution.error_per_depth = kErrorPerDepth;
    // As many for a superpixel as usual, which is larger than here.
    options_.pixels_per_observation = 60.f;
    labeled_.labels.assign(kNumSuperpixels, -1);
    labeled_.evidence.assign(kNumSuperpixels, LabelEvidence::kNone);
  }

  // noise: standard deviation in pixels of disparity.
  void Measure(const Shape& shape, double noise = 0.1) {
    Philox random(5, 0, 0);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const Vec3f ray = inputs_.intrinsics.Ray(x, y);
        const float depth = shape(ray);
        const double error = noise *
                             inputs_.resolution.RelativeDepthError(depth) *
                             NextNormal(&random);
        inputs_.samples(x, y) = {
            ray.x, ray.y, depth * static_cast<float>(1.0 + error)};
      }
    }
  }

  // Gives each block of superpixels the plane that fits its measurements best.
  void MakeFacets(int columns = kFacet, int rows = kNumRows / 2) {
    labeled_.planes.clear();
    for (int row = 0; row < kNumRows; row += rows) {
      for (int column = 0; column < kNumColumns; column += columns) {
        PlaneRegression regression;
        for (int y = row * kSize; y < (row + rows) * kSize; ++y) {
          for (int x = column * kSize; x < (column + columns) * kSize; ++x) {
            regression.Add(inputs_.samples(x, y), 1.0);
          }
        }
        for (int i = row; i < row + rows; ++i) {
          for (int j = column; j < column + columns; ++j) {
            SetLabel(i * kNumColumns + j,
                     static_cast<int>(labeled_.planes.size()));
          }
        }
        labeled_.planes.push_back(regression.Solve());
      }
    }
  }

  void SetLabel(int s, int label) {
    labeled_.labels[s] = label;
    labeled_.evidence[s] =
        label < 0 ? LabelEvidence::kNone : LabelEvidence::kMeasured;
  }

  // Forgets what was measured there.
  void Clear(int first_column, int first_row, int last_column, int last_row) {
    for (int y = first_row * kSize; y < (last_row + 1) * kSize; ++y) {
      for (int x = first_column * kSize; x < (last_column + 1) * kSize; ++x) {
        inputs_.samples(x, y) = RayDepth{};
      }
    }
    for (int row = first_row; row <= last_row; ++row) {
      for (int column = first_column; column <= last_column; ++column) {
        SetLabel(row * kNumColumns + column, -1);
      }
    }
  }

  CurvedView Find() const {
    const ViewEvidence evidence = GatherEvidence(inputs_, {});
    std::vector<ObservedView> views = {{&evidence, camera_}};
    ViewEvidence witness;
    if (witness_depth_ > 0.f) {
      witness.resolution.error_per_depth = inputs_.resolution.error_per_depth;
      witness.width = kWidth;
      witness.height = kHeight;
      witness.first_observation = {0};
      witness.strong_depth = Image<float>(kWidth, kHeight, witness_depth_);
      views.push_back({&witness, camera_});
    }
    return FindCurvedSurfaces(views, labeled_, options_);
  }

  // The depths and normals of the surfaces are those of the shape, up to one
  // pixel of disparity and a few degrees.
  void ExpectShape(const CurvedView& view,
                   const Shape& shape,
                   float max_degrees) const {
    float error = 0.f;  // In pixels of disparity.
    float angle = 0.f;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const int k = view.labels[inputs_.superpixels(x, y)];
        if (k < 0) {
          continue;
        }
        const Vec3f ray = inputs_.intrinsics.Ray(x, y);
        const Plane tangent = view.surfaces[k].TangentAt(ray);
        const float depth = shape(ray);
        error = std::max(
            error,
            std::abs(tangent.Depth(ray) - depth) /
                (depth * inputs_.resolution.RelativeDepthError(depth)));
        const auto point = [&](float dx, float dy) {
          const Vec3f at = inputs_.intrinsics.Ray(x + dx, y + dy);
          return at * shape(at);
        };
        const Vec3f normal =
            Normalized(Cross(point(0.f, 1.f) - point(0.f, -1.f),
                             point(1.f, 0.f) - point(-1.f, 0.f)));
        angle = std::max(angle, AngleBetween(tangent.normal, normal));
      }
    }
    EXPECT_LT(error, 1.f);
    EXPECT_LT(angle, max_degrees);
  }

  static int CountCurved(const CurvedView& view) {
    return static_cast<int>(
        std::count_if(view.labels.begin(), view.labels.end(), [](int label) {
          return label >= 0;
        }));
  }

  void ExpectNothing() const {
    const CurvedView view = Find();
    EXPECT_TRUE(view.surfaces.empty());
    EXPECT_EQ(CountCurved(view), 0);
    EXPECT_EQ(view.evidence, labeled_.evidence);
  }

  Camera camera_;
  EvidenceInputs inputs_;
  LabeledView labeled_;
  CurvedSurfaceOptions options_;
  // Of a second view at the same place, known everywhere; 0: there is none.
  float witness_depth_ = 0.f;
};

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

TEST_F(CurvedSurfacesTest, APlaneStaysAPlane) {
  const Plane plane = DrawnPlane({0.3f, 0.2f, -1.f}, 4.f);
  for (const double noise : {0.0, 0.1, 0.3, 0.6}) {
    Measure([&](const Vec3f& ray) { return plane.Depth(ray); }, noise);
    MakeFacets(kNumColumns, kNumRows);
    ExpectNothing();
    MakeFacets();
    ExpectNothing();
  }
}

TEST_F(CurvedSurfacesTest, ASlightBendMayBeAnErrorThatAllOfAWallHasInCommon) {
  Measure([](const Vec3f& ray) {
    return 4.f + 4.f * kPixel * 0.4f * (ray.x * ray.x + ray.y * ray.y);
  });
  MakeFacets(kNumColumns / 2, kNumRows);
  ExpectNothing();
  options_.min_improvement = 0.f;
  EXPECT_EQ(Find().surfaces.size(), 1u);
}

TEST_F(CurvedSurfacesTest, ACreaseStaysTwoPlanes) {
  const Plane left = DrawnPlane({-0.4f, 0.f, -1.f}, 4.f);
  const Plane right = DrawnPlane({0.4f, 0.f, -1.f}, 4.f);
  for (const double noise : {0.0, 0.3}) {
    Measure(
        [&](const Vec3f& ray) {
          return ray.x < 0.f ? left.Depth(ray) : right.Depth(ray);
        },
        noise);
    MakeFacets(kNumColumns / 2, kNumRows);
    ExpectNothing();
  }
}

TEST_F(CurvedSurfacesTest, TwoWallsBehindEachOtherStayApart) {
  Measure([](const Vec3f& ray) { return ray.x < 0.f ? 4.f : 5.f; });
  MakeFacets(kNumColumns / 2, kNumRows);
  ExpectNothing();
}

TEST_F(CurvedSurfacesTest, NoiseIsNoSurface) {
  Measure([](const Vec3f&) { return 4.f; }, 10.0);
  ExpectNothing();
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

TEST_F(CurvedSurfacesTest, DoesNotHideWhatOtherViewsSawThroughIt) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, false); });
  Clear(6, 4, 9, 7);
  witness_depth_ = 6.f;
  const int inside = 5 * kNumColumns + 7;
  // What was measured outweighs one view.
  const CurvedView view = Find();
  EXPECT_GE(view.labels[0], 0);
  EXPECT_EQ(view.labels[inside], -1);
  options_.labels.cost_of_contradiction = 0.f;
  EXPECT_GE(Find().labels[inside], 0);
}

TEST_F(CurvedSurfacesTest, OtherViewsCarryWhatTheySawToo) {
  const Shape shape = [](const Vec3f& ray) { return Round(40.f, ray, false); };
  Measure(shape);
  Clear(6, 4, 9, 7);
  witness_depth_ = 4.f;
  EXPECT_EQ(Find().evidence[5 * kNumColumns + 7], LabelEvidence::kCarried);
}

TEST_F(CurvedSurfacesTest, ThePlaneOfARegionKeepsASurfaceOut) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, false); });
  Clear(6, 4, 9, 7);
  inputs_.region_planes = Image<Plane>(kWidth, kHeight);
  for (int y = 4 * kSize; y < 8 * kSize; ++y) {
    for (int x = 6 * kSize; x < 10 * kSize; ++x) {
      inputs_.region_planes(x, y) = DrawnPlane({0.f, 0.f, -1.f}, 4.5f);
    }
  }
  const CurvedView view = Find();
  for (int s = 0; s < kNumSuperpixels; ++s) {
    const int row = s / kNumColumns;
    const int column = s % kNumColumns;
    const bool is_region = row >= 4 && row < 8 && column >= 6 && column < 10;
    EXPECT_EQ(view.labels[s] < 0, is_region) << row << " " << column;
  }
}

TEST_F(CurvedSurfacesTest, LeavesPlanesThatItDoesNotReplace) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, false); });
  Clear(6, 4, 9, 7);
  labeled_.planes = {DrawnPlane({0.f, 0.f, -1.f}, 4.f)};
  const int inside = 5 * kNumColumns + 7;
  SetLabel(inside, 0);
  labeled_.evidence[inside] = LabelEvidence::kCarried;
  const CurvedView view = Find();
  EXPECT_EQ(view.labels[inside], -1);
  EXPECT_EQ(view.evidence[inside], LabelEvidence::kCarried);
  EXPECT_GE(view.labels[inside + 1], 0);
}

TEST_F(CurvedSurfacesTest, DoesNotReachBeyondWhatWasMeasured) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, false); });
  Clear(8, 0, kNumColumns - 1, kNumRows - 1);
  const CurvedView view = Find();
  for (int s = 0; s < kNumSuperpixels; ++s) {
    EXPECT_EQ(view.labels[s] >= 0, s % kNumColumns < 8);
  }
}

TEST_F(CurvedSurfacesTest, AFewMeasurementsAreNoSurface) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, false); });
  Clear(2, 0, kNumColumns - 1, kNumRows - 1);
  Clear(0, 1, 1, kNumRows - 1);
  ExpectNothing();
  Clear(0, 0, 1, 0);
  ExpectNothing();
}

TEST_F(CurvedSurfacesTest, WhatBendsTooFarIsNoSurface) {
  Measure([](const Vec3f& ray) { return Round(10.f, ray, true); });
  MakeFacets();
  options_.max_sagitta = 0.03f;
  for (const CurvedSurface& surface : Find().surfaces) {
    const float* c = surface.coefficients;
    EXPECT_LE(std::abs(c[3]) + std::abs(c[4]) + std::abs(c[5]), 0.03f * c[0]);
  }
  options_.max_sagitta = 0.f;
  ExpectNothing();
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

TEST_F(CurvedSurfacesTest, PutsTangentsWhereSurfacesAre) {
  const Plane wall = DrawnPlane({0.f, 0.f, -1.f}, 5.f);
  CurvedView view;
  view.surfaces = {{0.f, 0.f, 1.f, {0.25f, 0.f, 0.f, 0.1f, 0.f, 0.f}}};
  view.labels = {-1, 0};
  const Image<uint16_t> superpixels = [] {
    Image<uint16_t> labels(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = kWidth / 2; x < kWidth; ++x) {
        labels(x, y) = 1;
      }
    }
    return labels;
  }();
  for (const int num_threads : {1, 4}) {
    const std::unique_ptr<Device> device = Device::CreateCpu(num_threads);
    DeviceImage<Plane> planes(*device, Image<Plane>(kWidth, kHeight, wall));
    PutCurvedSurfaces(view, superpixels, inputs_.intrinsics, *device, &planes);
    const Image<Plane> put = planes.ToHost();
    for (const int x : {0, kWidth / 2 - 1, kWidth / 2, kWidth - 1}) {
      const Plane expected =
          x < kWidth / 2
              ? wall
              : view.surfaces[0].TangentAt(inputs_.intrinsics.Ray(x, 7));
      EXPECT_EQ(put(x, 7).normal, expected.normal);
      EXPECT_EQ(put(x, 7).offset, expected.offset);
    }
  }
}

}  // namespace
}  // namespace tsar
