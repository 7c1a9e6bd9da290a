// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/device/buffer.h"

#include <cstdint>
#include <vector>

namespace tsar {

// Lengths are in pixels of the raster, for superpixels of 400 pixels. Depth
// differences are in relative depths of one pixel of disparity.
struct BorderOptions {
  // The distance from a border up to which pixels may change sides: a matching
  // window extends depths that far beyond an edge.
  int reach = 10;
  // The approximate radius within which neighbors vote.
  int radius = 16;
  int num_rounds = 4;  // At least 1.
  // Scales of the fall-off of a neighbor's vote with its distance, and with the
  // color difference in CIELAB.
  float spatial_sigma = 12.f;
  float color_sigma = 5.f;
  // Planes closer to each other than this count as one.
  float min_gap = 1.f;
  // The largest residual of a measurement that lies on a plane.
  float on_plane = 1.2f;
  // The range of lightness (0-100) in the 3x3 pixels around a measurement at
  // which its reliability is one half.
  float contrast = 10.f;
  // The vote of a pixel without a reliable measurement; that of a certain
  // measurement of the plane is 1.
  float vote_of_unmeasured = 0.5f;
};

// Inputs are on the raster of the superpixels, unless said otherwise.
struct BorderInputs {
  ImageView<const uint16_t> superpixels;
  ImageView<const Vec3f> lab;  // The image in CIELAB.
  // Measurements and their MeasurementFlags, of the size of the map, which is
  // as large as the raster or larger.
  ImageView<const float> depth;
  ImageView<const uint8_t> flags;
  Intrinsics intrinsics;  // Of the raster.
  DepthResolution resolution;
};

struct RefinedBorders {
  // Each pixel's superpixel, which may have become one nearby.
  DeviceImage<uint16_t> superpixels;
  // 1 where a measurement off the pixel's plane is of the surface across the
  // next edge, to which the matching window extends.
  DeviceImage<uint8_t> fattened;
};

// Reassigns pixels near borders between superpixels on different planes to one
// of at most four sides. The pixels around vote, each for its own plane, with a
// weight by similar color and by how well they measured that plane.
// Measurements count where the pixel itself has texture, since elsewhere the
// window saw only the edge beside it. In the same way, pixels of similar color
// with texture vote on measurements off their pixel's plane.
RefinedBorders RefineBorders(const BorderInputs& inputs,
                             const std::vector<int>& labels,
                             const std::vector<Plane>& planes,
                             const BorderOptions& options,
                             Device& device);

// Marks the measurements of the map as not trusted, in its flags, in the
// pixels of the raster that are fattened.
void DistrustFattened(ImageView<const uint8_t> fattened,
                      ImageView<uint8_t> flags,
                      Device& device);

}  // namespace tsar
