// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/compose_surfaces.h"

#include <utility>

namespace tsar {

ComposedMap ComposeSurfaces(const PlaneRaster& region_planes,
                            const RefineOptions& options,
                            Surfaces* surfaces,
                            DeviceViews* views,
                            Device& device) {
  const bool is_spread = !surfaces->spread.depth.Empty();
  DeviceImage<Plane> superpixel_planes;
  if (options.superpixel_planes && surfaces->superpixels.count > 0 &&
      !is_spread) {
    superpixel_planes =
        PlanesOfLabels(std::as_const(surfaces->superpixels.labels).View(),
                       surfaces->superpixel_planes,
                       device);
  }
  return ComposeMap(
      is_spread ? std::move(surfaces->spread) : views->TakeHypotheses(),
      {std::as_const(surfaces->trusted).View(),
       views->OnMap(superpixel_planes),
       region_planes,
       std::as_const(surfaces->confirmations).View()},
      views->Scale(),
      {},
      device);
}

}  // namespace tsar
