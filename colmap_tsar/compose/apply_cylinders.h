// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/compose/depth_sigma.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/scene/surfaces/seen_cylinders.h"
#include "colmap_tsar/view/compose.h"

#include <cstdint>
#include <vector>

namespace tsar {

// The pixels of a map that lie on cylinders.
struct AppliedCylinders {
  Buffer<SeenCylinder> cylinders;
  // 1 + the index of the pixel's cylinder, 0 = none; empty without cylinders.
  DeviceImage<uint8_t> labels;
};

// Replaces the depths of a composed map by the nearest of the cylinders whose
// outlines the view shows: it occludes what is behind it and is not occluded
// there. Measurements in front of it are kept, as are depths off it on distinct
// texture that another view confirms, except close to the outlines. Replaced
// pixels have the provenance kInterpolated. flags: see MeasurementFlags;
// intrinsics: both of the map. At most the first 255 cylinders are applied.
AppliedCylinders ApplyCylinders(const std::vector<SeenCylinder>& cylinders,
                                ImageView<const uint8_t> flags,
                                const Intrinsics& intrinsics,
                                const DepthResolution& resolution,
                                ComposedMap* composed,
                                Device& device);

// Sets the confidence of the depths on cylinders.
void SetConfidenceOfCylinders(const AppliedCylinders& applied,
                              DeviceImage<float>* confidence,
                              Device& device);

// Sets the standard deviations (RefinedMaps::sigma) of those that still have a
// depth. intrinsics, resolution: as above.
void SetSigmaOfCylinders(const AppliedCylinders& applied,
                         const Intrinsics& intrinsics,
                         const DepthResolution& resolution,
                         const DepthNormalImages& map,
                         const SceneSigmaOptions& options,
                         DeviceImage<uint16_t>* sigma,
                         Device& device);

}  // namespace tsar
