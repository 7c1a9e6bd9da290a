// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/plane_map.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/pipeline/on_plane.h"

namespace tsar {
namespace {

struct PlaneMapKernel {
  ImageView<const float> depth;
  PlaneRaster scene_planes;
  ImageView<const uint16_t> numbers;
  ImageView<uint16_t> map;

  TSAR_HD void operator()(int x, int y) const {
    map(x, y) =
        IsOnPlane(scene_planes, x, y, depth(x, y))
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
