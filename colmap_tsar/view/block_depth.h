// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/macros.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"

#include <cmath>
#include <cstddef>

namespace tsar {

// Finds the pixel whose hypothesis represents a block of pixels of a map (see
// ReduceView()), for GPU threads without a buffer or sorting: blocks are small.
struct BlockDepth {
  ImageView<const float> depth;
  ImageView<const Vec3f> normal;
  Intrinsics intrinsics;  // Those of the full map.
  int factor = 1;
  int first_row = 0;  // Row of the full map at which the rasters start.

  // The index of the pixel in the rasters, or -1 if there is none. (x, y):
  // indices of the block in the rasters.
  TSAR_HD ptrdiff_t Find(int x, int y) const {
    const Block block = {x * factor,
                         y * factor,
                         Smaller(x * factor + factor, depth.width),
                         Smaller(y * factor + factor, depth.height)};
    int count = 0;
    block.ForEach([&](int column, int row) {
      count += depth(column, row) > 0.f ? 1 : 0;
    });
    const int num_pixels = block.NumPixels();
    const int min_count = MinCount(num_pixels);
    if (count < min_count) {
      return -1;
    }
    // Missing depths are 0, below all others.
    const ptrdiff_t median =
        PixelOfRank(block, num_pixels - count + (count - 1) / 2);
    return CountOnPlane(block, median) >= min_count ? median : -1;
  }

  // The depth of a pixel's hypothesis, moved along its plane to another ray.
  TSAR_HD float DepthOnRay(ptrdiff_t pixel, const Vec3f& ray) const {
    return DepthOnRay(PlaneOf(pixel), depth.data[pixel], ray);
  }

  TSAR_HD Plane PlaneOf(ptrdiff_t pixel) const {
    return Plane::FromPoint(RayOf(static_cast<int>(pixel % depth.width),
                                  static_cast<int>(pixel / depth.width)),
                            depth.data[pixel],
                            normal.data[pixel]);
  }

  TSAR_HD Vec3f RayOf(int column, int row) const {
    return intrinsics.Ray(static_cast<float>(column),
                          static_cast<float>(first_row + row));
  }

  // The least number of depths of a valid block: one pixel in kPixelsPerGap
  // may have none.
  TSAR_HD static int MinCount(int num_pixels) {
    constexpr int kPixelsPerGap = 8;
    return num_pixels - num_pixels / kPixelsPerGap;
  }

  // Whether a depth lies on the plane of another. ray: that of the former.
  TSAR_HD static bool IsOnPlane(float depth,
                                const Vec3f& ray,
                                const Plane& plane,
                                float depth_of_plane) {
    // The largest residual of a block's depths to its plane, as a fraction of
    // depth.
    constexpr float kMaxResidual = 0.005f;
    const float expected = DepthOnRay(plane, depth_of_plane, ray);
    return fabsf(depth - expected) <= kMaxResidual * depth_of_plane;
  }

 private:
  TSAR_HD static float DepthOnRay(const Plane& plane,
                                  float depth,
                                  const Vec3f& ray) {
    // Bounds the change along a plane seen at a grazing angle.
    constexpr float kMaxDepthChange = 0.02f;
    const float on_ray = plane.Depth(ray);
    return on_ray > 0.f && fabsf(on_ray - depth) <= kMaxDepthChange * depth
               ? on_ray
               : depth;
  }

  // The half-open pixel ranges [begin, end).
  struct Block {
    int begin_x;
    int begin_y;
    int end_x;
    int end_y;

    TSAR_HD int NumPixels() const {
      return (end_x - begin_x) * (end_y - begin_y);
    }

    template <typename Function>
    TSAR_HD void ForEach(const Function& visit) const {
      for (int y = begin_y; y < end_y; ++y) {
        for (int x = begin_x; x < end_x; ++x) {
          visit(x, y);
        }
      }
    }
  };

  TSAR_HD static int Smaller(int a, int b) { return a < b ? a : b; }

  // The first pixel whose depth has this rank among all, from 0 on.
  TSAR_HD ptrdiff_t PixelOfRank(const Block& block, int rank) const {
    for (int y = block.begin_y; y < block.end_y; ++y) {
      for (int x = block.begin_x; x < block.end_x; ++x) {
        const float one = depth(x, y);
        int num_nearer = 0;
        int num_as_near = 0;
        block.ForEach([&](int u, int v) {
          num_nearer += depth(u, v) < one ? 1 : 0;
          num_as_near += depth(u, v) == one ? 1 : 0;
        });
        if (num_nearer <= rank && rank < num_nearer + num_as_near) {
          return static_cast<ptrdiff_t>(depth.Index(x, y));
        }
      }
    }
    return -1;
  }

  // How many of the block's depths lie on the plane of one of them.
  TSAR_HD int CountOnPlane(const Block& block, ptrdiff_t one) const {
    const Plane plane = PlaneOf(one);
    int count = 0;
    block.ForEach([&](int x, int y) {
      count += IsOnPlane(depth(x, y), RayOf(x, y), plane, depth.data[one]);
    });
    return count;
  }
};

}  // namespace tsar
