// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// PatchMatch stereo with adaptive checkerboard propagation and joint view
// selection (Xu and Tao, "Multi-Scale Geometric Consistency Guided Multi-View
// Stereo", CVPR 2019), on which the paper builds: every pixel has one plane,
// and adopts that of another pixel or a perturbed one if it matches better.

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

#include <cstdint>

namespace tsar {

// The most sources of one image.
constexpr int kMaxMatchedSources = 256;

struct PatchMatchOptions {
  // Each iteration updates all pixels, one color after the other.
  int num_iterations = 4;
  // The number of earlier iterations: perturbations decrease from one iteration
  // to the next.
  int num_past_iterations = 0;
  float window_radius = 5.f;  // In pixels; the window has 36 samples.
  // The range of drawn depths, in units of the model.
  float depth_min = 0.f;
  float depth_max = 0.f;
  // Weight of the geometric term, per pixel of reprojection error, and the
  // error at which it is truncated.
  float geometric_weight = 0.2f;
  float max_geometric_error = 3.f;
};

// The plane of every pixel and its cost: the mean over the selected sources of
// 1 - NCC plus the geometric term, in [0, 2 + geometric_weight *
// max_geometric_error].
struct PlaneHypotheses {
  DeviceImage<Plane> planes;
  DeviceImage<float> costs;
};

// The inputs of PatchMatch; reference.depth and reference.normal are not used.
// If the sources have depth, costs have the geometric term.
struct PatchMatchInputs {
  ReferenceView reference;
  const SourceViews& sources;  // At most kMaxMatchedSources.
  // Key of the random numbers: the same stream gives the same result.
  uint32_t stream = 0;
  // 1 for pixels that keep their planes, which others may adopt; may be empty.
  ImageView<const uint8_t> keeps_plane = {};
};

// Draws planes through random points of the rays, with uniform inverse depth
// between the bounds and random normals that face the camera.
DeviceImage<Plane> DrawPlanes(const Intrinsics& intrinsics,
                              int width,
                              int height,
                              uint32_t stream,
                              const PatchMatchOptions& options,
                              Device& device);

// Optimizes the planes. Throws kBadOption for too many sources.
PlaneHypotheses RunPatchMatch(const PatchMatchInputs& inputs,
                              DeviceImage<Plane> planes,
                              const PatchMatchOptions& options,
                              Device& device);

}  // namespace tsar
