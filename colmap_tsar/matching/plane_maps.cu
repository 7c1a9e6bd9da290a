// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/plane_maps.h"

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"

#include <cmath>

namespace tsar {
namespace {

struct ResizeKernel {
  ImageView<const Plane> from;
  int width;
  int height;

  TSAR_HD Plane operator()(int x, int y) const {
    const int u = static_cast<int>((x + 0.5f) * from.width / width);
    const int v = static_cast<int>((y + 0.5f) * from.height / height);
    return from(u < from.width ? u : from.width - 1,
                v < from.height ? v : from.height - 1);
  }
};

struct FromMapsKernel {
  Intrinsics intrinsics;
  ImageView<const float> depth;
  ImageView<const Vec3f> normal;

  TSAR_HD Plane operator()(int x, int y) const {
    return depth(x, y) > 0.f
               ? Plane::FromPoint(
                     intrinsics.Ray(x, y), depth(x, y), normal(x, y))
               : Plane{};
  }
};

struct ToMapsKernel {
  Intrinsics intrinsics;
  ImageView<const Plane> planes;
  ImageView<float> depth;
  ImageView<Vec3f> normal;

  TSAR_HD void operator()(int x, int y) const {
    const Plane& plane = planes(x, y);
    const float z = plane.Valid() ? plane.Depth(intrinsics.Ray(x, y)) : 0.f;
    depth(x, y) = z;
    normal(x, y) = z > 0.f ? plane.normal : Vec3f{};
  }
};

constexpr int kSmoothingRadius = 2;  // Radius of the window, in pixels.
// The largest distance of a neighbor's depth from the pixel's plane, as a
// fraction of depth, and the least cosine between normals of one surface.
constexpr float kMaxDepthError = 0.01f;
constexpr float kMinCosAngle = 0.7f;

struct SmoothKernel {
  Intrinsics intrinsics;
  ImageView<const float> depth;
  ImageView<const Vec3f> normal;

  TSAR_HD Vec3f operator()(int x, int y) const {
    const Vec3f own = normal(x, y);
    if (!(depth(x, y) > 0.f)) {
      return own;
    }
    const Vec3f ray = intrinsics.Ray(x, y);
    const Plane plane = Plane::FromPoint(ray, depth(x, y), own);
    Vec3f sum = {};
    for (int v = y - kSmoothingRadius; v <= y + kSmoothingRadius; ++v) {
      for (int u = x - kSmoothingRadius; u <= x + kSmoothingRadius; ++u) {
        if (!depth.Contains(u, v) || !(depth(u, v) > 0.f) ||
            Dot(own, normal(u, v)) < kMinCosAngle ||
            fabsf(plane.Depth(intrinsics.Ray(u, v)) - depth(u, v)) >
                kMaxDepthError * depth(u, v)) {
          continue;
        }
        sum = sum + normal(u, v);
      }
    }
    const Vec3f mean = Normalized(sum);
    return Dot(mean, ray) < 0.f ? mean : own;
  }
};

}  // namespace

DepthNormalImages MapsFromPlanes(const Intrinsics& intrinsics,
                                 ImageView<const Plane> planes,
                                 Device& device) {
  DepthNormalImages maps(device, planes.width, planes.height);
  ParallelFor(
      device,
      planes.width,
      planes.height,
      ToMapsKernel{intrinsics, planes, maps.depth.View(), maps.normal.View()});
  return maps;
}

DeviceImage<Plane> ResizePlanes(ImageView<const Plane> planes,
                                int width,
                                int height,
                                Device& device) {
  return MapPixels<Plane>(
      device, width, height, ResizeKernel{planes, width, height});
}

DeviceImage<Plane> PlanesFromMaps(const Intrinsics& intrinsics,
                                  ImageView<const float> depth,
                                  ImageView<const Vec3f> normal,
                                  Device& device) {
  return MapPixels<Plane>(device,
                          depth.width,
                          depth.height,
                          FromMapsKernel{intrinsics, depth, normal});
}

DeviceImage<Vec3f> SmoothNormals(const Intrinsics& intrinsics,
                                 ImageView<const float> depth,
                                 ImageView<const Vec3f> normal,
                                 Device& device) {
  return MapPixels<Vec3f>(device,
                          depth.width,
                          depth.height,
                          SmoothKernel{intrinsics, depth, normal});
}

}  // namespace tsar
