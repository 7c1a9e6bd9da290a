// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/samples.h"

#include "colmap_tsar/device/parallel_for_pixels.h"

namespace tsar {
namespace {

struct SampleKernel {
  ImageView<const float> depth;
  ImageView<const float> score;
  ImageView<const uint8_t> reliable;
  Intrinsics intrinsics;
  ReducedRaster raster;

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

  TSAR_HD RayDepth operator()(int column, int row) const {
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
    return best;
  }
};

struct ReduceNearestKernel {
  ImageView<const float> map;
  ReducedRaster raster;

  TSAR_HD float operator()(int x, int y) const {
    return ValueOnMap(map, x, y, raster.width, raster.height);
  }
};

template <typename Label>
struct PlanesOfLabelsKernel {
  ImageView<const Label> labels;
  const Plane* planes;

  TSAR_HD Plane operator()(int x, int y) const {
    const int label = labels(x, y);
    return label >= 0 ? planes[label] : Plane{};
  }
};

// The pixels under a reduced pixel along one axis. Units are such that a pixel
// is `size` and a reduced pixel `full_size` long, so that all overlaps are
// integers.
struct Span {
  int64_t begin;  // Start in those units.
  int64_t end;
  int size;

  TSAR_HD Span(int i, int full_size, int size)
      : begin(static_cast<int64_t>(i) * full_size),
        end(begin + full_size),
        size(size) {}
  TSAR_HD int First() const { return static_cast<int>(begin / size); }
  TSAR_HD int Last() const { return static_cast<int>((end - 1) / size); }
  TSAR_HD int64_t Overlap(int pixel) const {
    const int64_t from = static_cast<int64_t>(pixel) * size;
    const int64_t to = from + size;
    return (to < end ? to : end) - (from > begin ? from : begin);
  }
};

struct ReduceColorKernel {
  ImageView<const Rgb> color;
  ReducedRaster raster;

  TSAR_HD Rgb operator()(int x, int y) const {
    const Span columns(x, color.width, raster.width);
    const Span rows(y, color.height, raster.height);
    int64_t r = 0;
    int64_t g = 0;
    int64_t b = 0;
    for (int row = rows.First(); row <= rows.Last(); ++row) {
      for (int column = columns.First(); column <= columns.Last(); ++column) {
        const int64_t weight = rows.Overlap(row) * columns.Overlap(column);
        const Rgb& pixel = color(column, row);
        r += weight * pixel.r;
        g += weight * pixel.g;
        b += weight * pixel.b;
      }
    }
    const int64_t area = static_cast<int64_t>(color.NumPixels());
    return {Mean(r, area), Mean(g, area), Mean(b, area)};
  }

  TSAR_HD static uint8_t Mean(int64_t sum, int64_t area) {
    return static_cast<uint8_t>((sum + area / 2) / area);
  }
};

}  // namespace

DeviceImage<RayDepth> SampleMeasurements(ImageView<const float> depth,
                                         ImageView<const float> score,
                                         ImageView<const uint8_t> reliable,
                                         const Intrinsics& intrinsics,
                                         const ReducedRaster& raster,
                                         Device& device) {
  return MapPixels<RayDepth>(
      device,
      raster.width,
      raster.height,
      SampleKernel{depth, score, reliable, intrinsics, raster});
}

DeviceImage<float> ReduceNearest(ImageView<const float> map,
                                 const ReducedRaster& raster,
                                 Device& device) {
  return MapPixels<float>(
      device, raster.width, raster.height, ReduceNearestKernel{map, raster});
}

template <typename Label>
DeviceImage<Plane> PlanesOfLabels(ImageView<const Label> labels,
                                  const Buffer<Plane>& planes,
                                  Device& device) {
  return MapPixels<Plane>(device,
                          labels.width,
                          labels.height,
                          PlanesOfLabelsKernel<Label>{labels, planes.Data()});
}

template DeviceImage<Plane> PlanesOfLabels(ImageView<const int>,
                                           const Buffer<Plane>&,
                                           Device&);
template DeviceImage<Plane> PlanesOfLabels(ImageView<const uint16_t>,
                                           const Buffer<Plane>&,
                                           Device&);

DeviceImage<Rgb> ReduceColor(ImageView<const Rgb> color,
                             const ReducedRaster& raster,
                             Device& device) {
  return MapPixels<Rgb>(
      device, raster.width, raster.height, ReduceColorKernel{color, raster});
}

}  // namespace tsar
