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
  ImageView<Plane> to;

  TSAR_HD void operator()(int x, int y) const {
    const int u = static_cast<int>((x + 0.5f) * from.width / to.width);
    const int v = static_cast<int>((y + 0.5f) * from.height / to.height);
    to(x, y) = from(u < from.width ? u : from.width - 1,
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

struct SmoothKernel {
  Intrinsics intrinsics;
  ImageView<const float> depth;
  ImageView<const Vec3f> normal;
  SmoothNormalsOptions options;

  TSAR_HD Vec3f operator()(int x, int y) const {
    const Vec3f own = normal(x, y);
    if (!(depth(x, y) > 0.f)) {
      return own;
    }
    const Vec3f ray = intrinsics.Ray(x, y);
    const Plane plane = Plane::FromPoint(ray, depth(x, y), own);
    Vec3f sum = {};
    for (int v = y - options.radius; v <= y + options.radius; ++v) {
      for (int u = x - options.radius; u <= x + options.radius; ++u) {
        if (!depth.Contains(u, v) || !(depth(u, v) > 0.f) ||
            Dot(own, normal(u, v)) < options.min_cos_angle ||
            fabsf(plane.Depth(intrinsics.Ray(u, v)) - depth(u, v)) >
                options.max_depth_error * depth(u, v)) {
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

PlaneMaps MapsFromPlanes(const Intrinsics& intrinsics,
                         ImageView<const Plane> planes,
                         Device& device) {
  PlaneMaps maps{DeviceImage<float>(device, planes.width, planes.height),
                 DeviceImage<Vec3f>(device, planes.width, planes.height)};
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
  DeviceImage<Plane> resized(device, width, height);
  ParallelFor(device, width, height, ResizeKernel{planes, resized.View()});
  return resized;
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
                                 const SmoothNormalsOptions& options,
                                 Device& device) {
  return MapPixels<Vec3f>(device,
                          depth.width,
                          depth.height,
                          SmoothKernel{intrinsics, depth, normal, options});
}

}  // namespace tsar
