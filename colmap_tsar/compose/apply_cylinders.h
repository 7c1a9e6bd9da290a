// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/compose/compose_map.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/scene/cylinders.h"

#include <cstdint>
#include <vector>

namespace tsar {

// Replaces the depths of a composed map by the nearest of the cylinders.
// Surfaces in front of it that were measured are kept, as are depths off it on
// distinct texture that another view confirms, except close to the outlines.
// Replaced pixels have the provenance kInterpolated. flags: see
// MeasurementFlags; intrinsics: both of the map. Returns the variance of each
// depth on a cylinder, above 0, and 0 where it is on none; empty without
// cylinders.
DeviceImage<float> ApplyCylinders(const std::vector<CameraCylinder>& cylinders,
                                  ImageView<const uint8_t> flags,
                                  const Intrinsics& intrinsics,
                                  const DepthResolution& resolution,
                                  ComposedMap* composed,
                                  Device& device);

}  // namespace tsar
