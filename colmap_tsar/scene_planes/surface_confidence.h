// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene_planes/label_view.h"

namespace tsar {

// The least confidence of a depth: 0 stands for no depth.
inline constexpr float kMinConfidence = 0.01f;

// The probabilities that depths are right to 1 %, by how they came about: of
// the pixels of one superpixel.
struct SurfaceConfidence {
  float moved = 0.f;   // Measured on its plane.
  float filled = 0.f;  // Not measured: the depth of its plane.
};

// By logistic regression (docs/method.md, "Confidence"); from kMinConfidence
// to as much below 1.
SurfaceConfidence RateSurface(LabelEvidence evidence,
                              const LabelQuality& quality);

// On curved surfaces, whose labels are not rated.
inline constexpr SurfaceConfidence kConfidenceOfCurved = {.moved = 0.76f,
                                                          .filled = 0.55f};

// On columns and pipes between their outlines.
inline constexpr float kConfidenceOfCylinder = 0.9f;

// Where the scene has no plane: of the plane of a region, and of what the
// weighted median interpolated.
inline constexpr float kConfidenceOfRegion = 0.47f;
inline constexpr float kConfidenceOfInterpolated = 0.31f;

}  // namespace tsar
