// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/plane_map.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/superpixels/samples.h"

namespace tsar {
namespace {

struct PlaneMapKernel {
  ImageView<const float> depth;
  PlaneRaster scene_planes;
  ImageView<const uint16_t> numbers;
  ImageView<uint16_t> map;

  TSAR_HD void operator()(int x, int y) const {
    const Plane plane = scene_planes.At(x, y);
    const bool is_on_plane =
        plane.Valid() && depth(x, y) > 0.f &&
        depth(x, y) == plane.Depth(scene_planes.intrinsics.Ray(x, y));
    map(x, y) =
        is_on_plane
            ? numbers(ReducedRaster::FromMap(x, depth.width, numbers.width),
                      ReducedRaster::FromMap(y, depth.height, numbers.height))
            : 0;
  }
};

}  // namespace

DeviceImage<uint16_t> MapPlanes(ImageView<const float> depth,
                                const PlaneRaster& scene_planes,
                                ImageView<const uint16_t> numbers,
                                Device& device) {
  DeviceImage<uint16_t> map(device, depth.width, depth.height);
  ParallelFor(device,
              depth.width,
              depth.height,
              PlaneMapKernel{depth, scene_planes, numbers, map.View()});
  return map;
}

}  // namespace tsar
