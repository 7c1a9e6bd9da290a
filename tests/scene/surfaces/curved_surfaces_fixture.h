// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Drawn surfaces, flat and curved, that were labeled by facets.

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"
#include "colmap_tsar/scene/surfaces/curved_surfaces.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/support/synthetic_observations.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {

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
inline float Round(float radius, const Vec3f& ray, bool is_sphere) {
  const float middle = 4.f + radius;
  const float a = ray.x * ray.x + (is_sphere ? ray.y * ray.y : 0.f) + 1.f;
  const float root = middle * middle - a * (middle * middle - radius * radius);
  return root > 0.f ? (middle - std::sqrt(root)) / a : 0.f;
}

using Shape = std::function<float(const Vec3f& ray)>;

// Square superpixels, numbered row by row, that see a shape.
class CurvedSurfacesTest : public testing::Test {
 protected:
  CurvedSurfacesTest() : camera_(SyntheticCamera(kWidth, kHeight, 160.0)) {
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
    const ViewEvidence evidence = GatherEvidence(inputs_).evidence;
    std::vector<ObservedView> views = {{&evidence, camera_}};
    ViewEvidence source;
    if (source_depth_ > 0.f) {
      source.resolution.error_per_depth = inputs_.resolution.error_per_depth;
      source.width = kWidth;
      source.height = kHeight;
      source.first_observation = {0};
      source.confident_depth = Image<float>(kWidth, kHeight, source_depth_);
      views.push_back({&source, camera_});
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
  float source_depth_ = 0.f;
};

}  // namespace tsar
