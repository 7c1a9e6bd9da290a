// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/rasterize_curved_surfaces.h"

#include "colmap_tsar/device/parallel_for.h"

namespace tsar {
namespace {

struct RasterizeKernel {
  const CurvedSurface* surfaces;
  const int* surface_of;  // Of each superpixel.
  ImageView<const uint16_t> superpixels;
  Intrinsics intrinsics;
  ImageView<Plane> planes;

  TSAR_HD void operator()(int x, int y) const {
    const int k = surface_of[superpixels(x, y)];
    if (k >= 0) {
      planes(x, y) = surfaces[k].TangentAt(intrinsics.Ray(x, y));
    }
  }
};

}  // namespace

void RasterizeCurvedSurfaces(const CurvedView& curved,
                             const Image<uint16_t>& superpixels,
                             const Intrinsics& intrinsics,
                             Device& device,
                             DeviceImage<Plane>* planes) {
  if (curved.surfaces.empty()) {
    return;
  }
  const Buffer<CurvedSurface> surfaces(device, curved.surfaces);
  const Buffer<int> surface_of(device, curved.labels);
  const DeviceImage<uint16_t> labels(device, superpixels);
  ParallelFor(device,
              planes->Width(),
              planes->Height(),
              RasterizeKernel{surfaces.Data(),
                              surface_of.Data(),
                              labels.View(),
                              intrinsics,
                              planes->View()});
}

}  // namespace tsar
