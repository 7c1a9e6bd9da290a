// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/plane_maps.h"

#include "colmap_tsar/device/parallel_for.h"

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
  ImageView<Plane> planes;

  TSAR_HD void operator()(int x, int y) const {
    planes(x, y) =
        depth(x, y) > 0.f
            ? Plane::FromPoint(intrinsics.Ray(x, y), depth(x, y), normal(x, y))
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
  DeviceImage<Plane> planes(device, depth.width, depth.height);
  ParallelFor(device,
              depth.width,
              depth.height,
              FromMapsKernel{intrinsics, depth, normal, planes.View()});
  return planes;
}

}  // namespace tsar
