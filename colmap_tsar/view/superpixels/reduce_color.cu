// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/reduce_color.h"

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {
namespace {

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
  ImageView<Rgb> reduced;

  TSAR_HD void operator()(int x, int y) const {
    const Span columns(x, color.width, reduced.width);
    const Span rows(y, color.height, reduced.height);
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
    reduced(x, y) = {Mean(r, area), Mean(g, area), Mean(b, area)};
  }

  TSAR_HD static uint8_t Mean(int64_t sum, int64_t area) {
    return static_cast<uint8_t>((sum + area / 2) / area);
  }
};

}  // namespace

DeviceImage<Rgb> ReduceColor(ImageView<const Rgb> color,
                             const ReducedRaster& raster,
                             Device& device) {
  DeviceImage<Rgb> reduced(device, raster.width, raster.height);
  ParallelFor(device,
              raster.width,
              raster.height,
              ReduceColorKernel{color, reduced.View()});
  return reduced;
}

}  // namespace tsar
