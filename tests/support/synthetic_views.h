// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Planes seen by five cameras, as inputs of the stages.

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/view/view_data.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/support/synthetic_scene.h"

namespace tsar {

// A surface; points are in the frame of the first camera.
struct DrawnPart {
  Plane plane;
  // Which points of the plane exist.
  std::function<bool(const Vec3f& point)> holds;
  // Without texture. There the maps hold nothing or, in one pixel in ten, a
  // wrong depth.
  std::function<bool(const Vec3f& point)> is_bare;
};

struct SyntheticViewsOptions {
  int width = 96;
  int height = 72;
  // Empty: a slanted wall.
  std::vector<DrawnPart> parts;
  // Whether that wall has a textureless middle in the first image.
  bool has_bare_part = true;
  // By how much the texture moves along x and y per unit of depth.
  float shear_x = 0.f;
  float shear_y = 0.f;
  // The largest relative error of the other depths.
  float noise = 1e-3f;
};

struct SyntheticViews {
  std::vector<ViewData> views;  // The first is the reference.
  Plane wall;                   // Where there are no other parts.
  std::vector<Image<float>> truths;
  Image<float> truth;  // Depths of the reference.

  std::vector<const ViewData*> Sources() const {
    std::vector<const ViewData*> sources;
    for (size_t i = 1; i < views.size(); ++i) {
      sources.push_back(&views[i]);
    }
    return sources;
  }
  // Whether a point of the reference's frame is on the textureless part.
  static bool IsBare(const Vec3f& point) {
    return std::abs(point.x) < 0.2f * point.z &&
           std::abs(point.y) < 0.15f * point.z;
  }
};

// Waves of about six to fifteen pixels in three directions.
inline float DrawnTexture(float x, float y) {
  return 128.f + 40.f * std::sin(0.9f * x + 0.2f * y) +
         30.f * std::sin(0.61f * y - 0.35f * x + 1.f) +
         20.f * std::sin(0.43f * x + 0.47f * y + 2.f);
}

inline SyntheticViews MakeSyntheticViews(const SyntheticViewsOptions& options) {
  SyntheticViews drawn;
  Camera camera = SyntheticCamera(
      options.width, options.height, std::max(options.width, options.height));
  constexpr float kDepth = 5.f;
  drawn.wall = DrawnPlane({0.2f, -0.1f, -1.f}, kDepth);
  std::vector<DrawnPart> parts = options.parts;
  if (parts.empty()) {
    const auto is_bare = [has = options.has_bare_part](const Vec3f& point) {
      return has && SyntheticViews::IsBare(point);
    };
    parts = {{drawn.wall, [](const Vec3f&) { return true; }, is_bare}};
  }
  const float pixels_per_unit = static_cast<float>(camera.fx) / kDepth;
  const Intrinsics intrinsics = camera.GetIntrinsics();
  for (const Vec3f& center : {Vec3f{0.f, 0.f, 0.f},
                              Vec3f{0.3f, 0.f, 0.f},
                              Vec3f{-0.3f, 0.f, 0.f},
                              Vec3f{0.f, 0.3f, 0.f},
                              Vec3f{0.2f, -0.3f, 0.f}}) {
    Philox random(static_cast<uint32_t>(drawn.views.size()), 0, 0);
    ViewData view;
    view.camera = camera;
    view.camera.translation = -Eigen::Vector3d(center.x, center.y, center.z);
    view.color = Image<Rgb>(options.width, options.height);
    view.depth = Image<float>(options.width, options.height);
    view.normal = Image<Vec3f>(options.width, options.height);
    Image<float> truth(options.width, options.height);
    for (int y = 0; y < options.height; ++y) {
      for (int x = 0; x < options.width; ++x) {
        const Vec3f ray = intrinsics.Ray(x, y);
        const DrawnPart* hit = nullptr;
        Vec3f point;
        float z = 0.f;
        for (const DrawnPart& part : parts) {
          const Plane plane{part.plane.normal,
                            part.plane.offset + Dot(part.plane.normal, center)};
          const float of_part = plane.Depth(ray);
          if (of_part > 0.f && (hit == nullptr || of_part < z) &&
              part.holds(of_part * ray + center)) {
            hit = &part;
            z = of_part;
            point = of_part * ray + center;
          }
        }
        truth(x, y) = z;
        const bool bare = hit->is_bare(point);
        const float level =
            bare ? 200.f
                 : DrawnTexture(
                       (point.x + options.shear_x * point.z) * pixels_per_unit,
                       (point.y + options.shear_y * point.z) * pixels_per_unit);
        const auto byte = static_cast<uint8_t>(std::lround(level));
        view.color(x, y) = {byte, byte, byte};
        const float choice = random.NextFloat();
        const float spread = 2.f * random.NextFloat() - 1.f;
        float depth = z * (1.f + options.noise * spread);
        if (bare) {
          depth = choice < 0.1f ? z * (1.f + 0.3f * spread) : 0.f;
        }
        view.depth(x, y) = depth;
        view.normal(x, y) = depth > 0.f ? hit->plane.normal : Vec3f{};
        view.num_depths += depth > 0.f ? 1 : 0;
      }
    }
    drawn.views.push_back(std::move(view));
    drawn.truths.push_back(std::move(truth));
  }
  drawn.truth = drawn.truths[0];
  return drawn;
}

}  // namespace tsar
