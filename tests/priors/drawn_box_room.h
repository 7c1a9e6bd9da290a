// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// A drawn room with a box in it, and measurements of some of its pixels.

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/base/random.h"

#include <functional>

#include "tests/support/synthetic_observations.h"
#include "tests/support/synthetic_scene.h"

namespace tsar {

constexpr int kRoomWidth = 160;
constexpr int kRoomHeight = 120;

struct DrawnBoxRoom {
  DrawnBoxRoom() {
    const Intrinsics intrinsics = camera.GetIntrinsics();
    const Plane planes[] = {DrawnPlane({0.2f, 0.f, -1.f}, 6.f),
                            {{0.f, -1.f, 0.f}, 1.3f},
                            {{1.f, 0.f, 0.f}, 2.f}};
    const Plane front = DrawnPlane({-0.1f, 0.f, -1.f}, 3.5f);
    for (int y = 0; y < kRoomHeight; ++y) {
      for (int x = 0; x < kRoomWidth; ++x) {
        const Vec3f ray = intrinsics.Ray(x, y);
        float nearest = 1e9f;
        for (const Plane& plane : planes) {
          const float z = plane.Depth(ray);
          nearest = z > 0.f && z < nearest ? z : nearest;
        }
        is_box(x, y) = x >= 84 && x < 124 && y >= 40 && y < 90 ? 1 : 0;
        depth(x, y) = is_box(x, y) != 0 ? front.Depth(ray) : nearest;
      }
    }
  }

  // Measures the pixels for which this is true, with normally distributed
  // errors of this standard deviation, relative to the depth.
  Image<RayDepth> Measure(const std::function<bool(int x, int y)>& is_measured,
                          double noise = 0.0) const {
    Philox random(3, 0, 0);
    Image<RayDepth> samples = ToSamples(depth, camera);
    for (int y = 0; y < kRoomHeight; ++y) {
      for (int x = 0; x < kRoomWidth; ++x) {
        const double error = noise * NextNormal(&random);
        samples(x, y).z *=
            is_measured(x, y) ? static_cast<float>(1.0 + error) : 0.f;
      }
    }
    return samples;
  }

  Camera camera = SyntheticCamera(kRoomWidth, kRoomHeight, 120.0);
  Image<float> depth{kRoomWidth, kRoomHeight};
  Image<uint8_t> is_box{kRoomWidth, kRoomHeight};
};

// Every third square of 4 x 4 pixels, in both directions.
inline bool IsInSparseSquare(int x, int y) {
  return x / 4 % 3 == 0 && y / 4 % 3 == 0;
}

}  // namespace tsar
