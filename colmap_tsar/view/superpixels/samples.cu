// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/samples.h"

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {
namespace {

struct SampleKernel {
  ImageView<const float> depth;
  ImageView<const float> score;
  ImageView<const uint8_t> reliable;
  Intrinsics intrinsics;
  ReducedRaster raster;
  ImageView<RayDepth> samples;

  // The first pixel of the map whose center falls into reduced pixel i.
  TSAR_HD static int First(int i, int map_size, int size) {
    int first =
        static_cast<int>(static_cast<float>(i) * map_size / size - 0.5f);
    first = first < 0 ? 0 : first;
    while (first > 0 &&
           ReducedRaster::FromMap(first - 1, map_size, size) >= i) {
      --first;
    }
    while (first < map_size &&
           ReducedRaster::FromMap(first, map_size, size) < i) {
      ++first;
    }
    return first;
  }

  TSAR_HD void operator()(int column, int row) const {
    RayDepth best;
    float best_score = -1.f;
    const int y_end = First(row + 1, depth.height, raster.height);
    const int x_end = First(column + 1, depth.width, raster.width);
    for (int y = First(row, depth.height, raster.height); y < y_end; ++y) {
      for (int x = First(column, depth.width, raster.width); x < x_end; ++x) {
        if (reliable(x, y) != 0 && depth(x, y) > 0.f &&
            score(x, y) > best_score) {
          best_score = score(x, y);
          const Vec3f ray = intrinsics.Ray(x, y);
          best = {ray.x, ray.y, depth(x, y)};
        }
      }
    }
    samples(column, row) = best;
  }
};

struct ReduceNearestKernel {
  ImageView<const float> map;
  ImageView<float> reduced;

  TSAR_HD void operator()(int x, int y) const {
    reduced(x, y) =
        map(static_cast<int>((x + 0.5f) * map.width / reduced.width),
            static_cast<int>((y + 0.5f) * map.height / reduced.height));
  }
};

template <typename Label>
struct PlanesOfLabelsKernel {
  ImageView<const Label> labels;
  const Plane* planes;
  ImageView<Plane> result;

  TSAR_HD void operator()(int x, int y) const {
    const int label = labels(x, y);
    result(x, y) = label >= 0 ? planes[label] : Plane{};
  }
};

template <typename Label>
DeviceImage<Plane> LookUpPlanes(ImageView<const Label> labels,
                                const Buffer<Plane>& planes,
                                Device& device) {
  DeviceImage<Plane> result(device, labels.width, labels.height);
  ParallelFor(
      device,
      labels.width,
      labels.height,
      PlanesOfLabelsKernel<Label>{labels, planes.Data(), result.View()});
  return result;
}

}  // namespace

DeviceImage<RayDepth> SampleMeasurements(ImageView<const float> depth,
                                         ImageView<const float> score,
                                         ImageView<const uint8_t> reliable,
                                         const Intrinsics& intrinsics,
                                         const ReducedRaster& raster,
                                         Device& device) {
  DeviceImage<RayDepth> samples(device, raster.width, raster.height);
  ParallelFor(
      device,
      raster.width,
      raster.height,
      SampleKernel{depth, score, reliable, intrinsics, raster, samples.View()});
  return samples;
}

DeviceImage<float> ReduceNearest(ImageView<const float> map,
                                 const ReducedRaster& raster,
                                 Device& device) {
  DeviceImage<float> reduced(device, raster.width, raster.height);
  ParallelFor(device,
              raster.width,
              raster.height,
              ReduceNearestKernel{map, reduced.View()});
  return reduced;
}

DeviceImage<Plane> PlanesOfLabels(ImageView<const int> labels,
                                  const Buffer<Plane>& planes,
                                  Device& device) {
  return LookUpPlanes(labels, planes, device);
}

DeviceImage<Plane> PlanesOfLabels(ImageView<const uint16_t> labels,
                                  const Buffer<Plane>& planes,
                                  Device& device) {
  return LookUpPlanes(labels, planes, device);
}

}  // namespace tsar
