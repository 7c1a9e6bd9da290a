// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/compose/compose_map.h"
#include "colmap_tsar/compose/compose_scene.h"

#include <cstdint>

namespace tsar {

// Standard deviations of depths on the right surface, in relative depths of one
// pixel of disparity, by provenance; benchmarks/fit_sigma.cc fits them.
struct SceneSigmaOptions {
  // In addition to the error of the plane: for depths measured on it, and for
  // those that it fills, by LabelOrigin.
  float moved = 0.2f;
  float filled_measured = 0.19f;
  float filled_carried = 0.24f;
  float filled_guessed = 0.26f;
  // For measurements off the plane, as a multiple of ViewEvidence::noise.
  float standing = 3.2f;
  float interpolated = 0.74f;
  // In addition to the error of the cylinder.
  float on_cylinder = 0.1f;
};

// Standard deviations where an image is refined on its own, by provenance
// alone.
struct ViewSigmaOptions {
  float measured = 0.22f;
  float superpixel_plane = 0.64f;
  float region_plane = 0.26f;
  float interpolated = 0.59f;
};

// The standard deviation of each depth of a map that ComposeScene made, in the
// units of the map, as positive halves (arithmetic.h); 0 where there is no
// depth. inputs: as for the composition. variances_on_cylinders: of
// ApplyCylinders(); may be empty. noise: ViewEvidence::noise.
DeviceImage<uint16_t> ComputeSceneSigma(
    const ComposedMap& composed,
    const ComposeSceneInputs& inputs,
    const DepthResolution& resolution,
    ImageView<const float> variances_on_cylinders,
    float noise,
    const SceneSigmaOptions& options,
    Device& device);

// The standard deviations where an image is refined on its own.
DeviceImage<uint16_t> ComputeSigma(const ComposedMap& composed,
                                   const DepthResolution& resolution,
                                   const ViewSigmaOptions& options,
                                   Device& device);

}  // namespace tsar
