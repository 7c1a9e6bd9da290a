// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// PatchMatch stereo with adaptive checkerboard propagation and joint view
// selection (Xu and Tao, "Multi-Scale Geometric Consistency Guided Multi-View
// Stereo", CVPR 2019), the prior of the paper: every pixel keeps one plane, and
// takes over that of another pixel, or a changed one, where it matches better.

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

#include <cstdint>

namespace tsar {

struct PatchMatchOptions {
  int num_iterations =
      4;  // Each updates all pixels, one color after the other.
  // How often the planes were updated before: changes get smaller from one
  // iteration to the next.
  int num_past_iterations = 0;
  float window_radius = 5.f;  // In pixels; the window has 36 samples.
  // Depths between which planes are drawn, in units of the model.
  float depth_min = 0.f;
  float depth_max = 0.f;
  // Weight of the geometric term, per pixel of reprojection error, and the
  // error from which on it stays the same.
  float geometric_weight = 0.2f;
  float max_geometric_error = 3.f;
  // Of the planar prior: what it costs to lie off it by prior_sigma, as a share
  // of its depth, or further.
  float prior_weight = 0.3f;
  float prior_sigma = 0.01f;
};

// A plane for every pixel and its cost: the mean over the selected sources of
// 1 - NCC plus the geometric term, in [0, 2 + geometric_weight *
// max_geometric_error], and the term of the prior, at most prior_weight.
struct PlaneHypotheses {
  DeviceImage<Plane> planes;
  DeviceImage<float> costs;
};

// What a run of PatchMatch reads; reference.depth and reference.normal are not.
// Where the sources have depth, costs have the geometric term. Where the pixel
// has a valid plane in the prior, it is a candidate, and costs have a term for
// depths off it (Xu and Tao, "Planar Prior Assisted PatchMatch Multi-View
// Stereo", AAAI 2020).
struct PatchMatchInputs {
  ReferenceView reference;
  const Buffer<SourceView>& sources;
  // Key of the random numbers: the same stream gives the same result.
  uint32_t stream = 0;
  ImageView<const Plane> prior = {};  // May be empty.
  // 1 for pixels that keep their planes, which others may take over; may be
  // empty.
  ImageView<const uint8_t> keeps_plane = {};
};

// Planes through random points of the rays, with uniform inverse depth between
// the bounds and any normal that faces the camera.
DeviceImage<Plane> DrawPlanes(const Intrinsics& intrinsics,
                              int width,
                              int height,
                              uint32_t stream,
                              const PatchMatchOptions& options,
                              Device& device);

// Improves the planes.
PlaneHypotheses RunPatchMatch(const PatchMatchInputs& inputs,
                              DeviceImage<Plane> planes,
                              const PatchMatchOptions& options,
                              Device& device);

}  // namespace tsar
