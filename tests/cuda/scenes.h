// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Drawn inputs of awkward sizes and contents for stages on any device.

#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/superpixels/slic.h"

#include <ostream>
#include <vector>

#include "tests/support/synthetic_views.h"

namespace tsar {

enum class SceneKind {
  kWall,     // Textured, with a bare part.
  kInvalid,  // No pixel has a depth.
  kEqual,    // All pixels of all maps and images are the same.
};

struct SceneSize {
  SceneKind kind = SceneKind::kWall;
  int width = 0;
  int height = 0;
};

// For the names of tests and their messages.
std::ostream& operator<<(std::ostream& out, const SceneSize& size);

std::vector<SceneSize> AllScenes();
// For stages that cost little: also an image wider than 65,536 pixels, and one
// of some size. The raster of both is smaller than the map.
std::vector<SceneSize> AllScenesAndWide();

SyntheticViews DrawScene(const SceneSize& size);

// Numbers in [0, max) that depend on the seed alone.
Image<float> RandomImage(int width, int height, float max, uint32_t seed);

// What the stages get from those before them, drawn instead of computed, so
// that every stage is compared for itself.
struct StageInputs {
  StageInputs(const SceneSize& size, Device& device);

  SyntheticViews drawn;
  DeviceViews views;
  DeviceImage<float> score;
  DeviceImage<uint8_t> reliable;
  DeviceImage<RayDepth> samples;  // On the raster.
  // Squares of 8 x 8 pixels of the raster.
  Superpixels squares;
};

}  // namespace tsar
