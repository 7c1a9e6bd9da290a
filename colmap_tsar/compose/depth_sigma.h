// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/view/compose.h"

#include <cstdint>

namespace tsar {

// Standard deviations of depths of the right surface, in relative depths of one
// pixel of disparity, by how the depths came about: benchmarks/fit_sigma.cc
// finds them.
struct SceneSigmaOptions {
  // Beside the error of the plane itself: of depths that were measured on it,
  // and of those that it fills, by LabelEvidence.
  float moved = 0.2f;
  float filled_measured = 0.19f;
  float filled_carried = 0.24f;
  float filled_guessed = 0.26f;
  // Measured off the plane: as a multiple of the spread of the view's
  // measurements.
  float standing = 3.2f;
  // Of planes of regions, and filled by curved surfaces.
  float no_plane = 0.54f;
  float moved_to_curved = 0.19f;
  float interpolated = 0.74f;
  // Beside the error of the cylinder itself (SetSigmaOfCylinders).
  float on_cylinder = 0.1f;
};

// The same where an image is refined on its own, by provenance alone.
struct ViewSigmaOptions {
  float measured = 0.22f;
  float superpixel_plane = 0.64f;
  float region_plane = 0.26f;
  float interpolated = 0.59f;
};

// The standard deviation of each depth of a map that ComposeScene made, in the
// units of the map, as positive halves (half.h); 0 where there is no depth.
// inputs: as for the composition. noise: ViewEvidence::noise.
DeviceImage<uint16_t> ComputeSceneSigma(const ComposedMap& composed,
                                        const ComposeSceneInputs& inputs,
                                        const DepthResolution& resolution,
                                        float noise,
                                        const SceneSigmaOptions& options,
                                        Device& device);

// The same where an image is refined on its own.
DeviceImage<uint16_t> ComputeSigma(const ComposedMap& composed,
                                   const DepthResolution& resolution,
                                   const ViewSigmaOptions& options,
                                   Device& device);

}  // namespace tsar
