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

// Which pixels of a map lie on cylinders.
struct LaidCylinders {
  Buffer<SeenCylinder> cylinders;
  // 1 + the number of the pixel's cylinder, 0 = none; empty without cylinders.
  DeviceImage<uint8_t> numbers;
};

// Replaces what a composed map holds by the nearest of the cylinders where the
// view shows the outlines of one: what is behind a cylinder cannot be seen, nor
// does anything else hide it there. What was measured in front of it stays, and
// so does a depth off it on distinct texture that another view confirms, except
// close to the outlines. Such pixels become interpolated ones. ratings: see
// MeasurementRating; intrinsics: both of the map. No more than 255 cylinders
// are laid, the first ones.
LaidCylinders LayCylinders(const std::vector<SeenCylinder>& cylinders,
                           ImageView<const uint8_t> ratings,
                           const Intrinsics& intrinsics,
                           const DepthResolution& resolution,
                           ComposedMap* composed,
                           Device& device);

// Sets the confidence of the depths on cylinders.
void RateCylinders(const LaidCylinders& laid,
                   DeviceImage<float>* confidence,
                   Device& device);

// Sets the standard deviations (RefinedMaps::sigma) of those that are still
// there. intrinsics, resolution: as above.
void SetSigmaOfCylinders(const LaidCylinders& laid,
                         const Intrinsics& intrinsics,
                         const DepthResolution& resolution,
                         const DepthNormalImages& map,
                         const SceneSigmaOptions& options,
                         DeviceImage<uint16_t>* sigma,
                         Device& device);

}  // namespace tsar
