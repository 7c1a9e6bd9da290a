// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/device/buffer.h"

#include <cfloat>
#include <cstdint>

namespace tsar {

// The raster of superpixels and regions: that of the map, or a smaller one of
// the same aspect ratio.
struct ReducedRaster {
  int width = 0;
  int height = 0;

  // The pixel of this raster that covers pixel x of a map of map_size pixels.
  TSAR_HD static int FromMap(int x, int map_size, int size) {
    return static_cast<int>((x + 0.5f) * size / map_size);
  }
};

// The value of a raster at the pixel that covers pixel (x, y) of a map of
// another size.
template <typename T>
TSAR_HD T& ValueOnMap(
    const ImageView<T>& raster, int x, int y, int map_width, int map_height) {
  return raster(ReducedRaster::FromMap(x, map_width, raster.width),
                ReducedRaster::FromMap(y, map_height, raster.height));
}

// The best reliable measurement under each pixel of the reduced raster, with
// its own ray, so that nothing is averaged or shifted; z = 0 where there is
// none. reliable: nonzero where a pixel may be used; score: the higher the
// better.
DeviceImage<RayDepth> SampleMeasurements(ImageView<const float> depth,
                                         ImageView<const float> score,
                                         ImageView<const uint8_t> reliable,
                                         const Intrinsics& intrinsics,
                                         const ReducedRaster& raster,
                                         Device& device);

// The value of the map's pixel at the center of each reduced pixel.
DeviceImage<float> ReduceNearest(ImageView<const float> map,
                                 const ReducedRaster& raster,
                                 Device& device);

// The plane of each pixel's label, an int or a uint16_t; invalid if the label
// is negative.
template <typename Label>
DeviceImage<Plane> PlanesOfLabels(ImageView<const Label> labels,
                                  const Buffer<Plane>& planes,
                                  Device& device);

// The planes of a reduced raster, accessed by pixels of the map.
struct PlaneRaster {
  ImageView<const Plane> planes;  // May be empty.
  Intrinsics intrinsics;          // Those of the map.
  int map_width = 0;
  int map_height = 0;

  // The plane of the map's pixel (x, y); invalid if there is none or this
  // pixel's ray does not meet it.
  TSAR_HD Plane At(int x, int y) const {
    if (planes.Empty()) {
      return {};
    }
    const Plane& plane = ValueOnMap(planes, x, y, map_width, map_height);
    const float depth = plane.Valid() ? plane.Depth(intrinsics.Ray(x, y)) : 0.f;
    return depth > 0.f && depth <= FLT_MAX ? plane : Plane{};
  }
};

// The image reduced to the raster: the mean of the pixels under each reduced
// one, weighted by the covered areas, rounded.
DeviceImage<Rgb> ReduceColor(ImageView<const Rgb> color,
                             const ReducedRaster& raster,
                             Device& device);

}  // namespace tsar
