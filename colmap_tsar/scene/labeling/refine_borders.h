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
  // How far from a border pixels may change sides: a matching window carries
  // depths so far beyond an edge.
  int reach = 10;
  // How far around a pixel neighbours vote, about.
  int radius = 16;
  int num_rounds = 4;  // At least 1.
  // How fast a neighbour's vote falls with its distance, and with the
  // difference of colour, in CIELAB.
  float spatial_sigma = 12.f;
  float color_sigma = 5.f;
  // Planes closer to each other than this are one.
  float min_gap = 1.f;
  // A measurement this close to a plane lies on it.
  float on_plane = 1.2f;
  // The step of lightness (0-100) in the 3x3 pixels around a measurement at
  // which it is believed by half.
  float contrast = 10.f;
  // What the vote of a pixel is worth that measured nothing to believe, against
  // 1 where the plane was measured for certain.
  float vote_of_unmeasured = 0.5f;
};

// On the raster of the superpixels, unless said otherwise.
struct BorderInputs {
  ImageView<const uint16_t> superpixels;
  ImageView<const Vec3f> lab;  // The image in CIELAB.
  // Of the map, which is as large as the raster or larger: the measurements,
  // and their MeasurementRating.
  ImageView<const float> depth;
  ImageView<const uint8_t> ratings;
  Intrinsics intrinsics;  // Of the raster.
  DepthResolution resolution;
};

struct RefinedBorders {
  // Each pixel's superpixel, which may now be one nearby.
  DeviceImage<uint16_t> superpixels;
  // 1 where a measurement off the pixel's plane is that of a surface behind the
  // next edge: it came with the matching window, not with the pixel.
  DeviceImage<uint8_t> fattened;
};

// Moves pixels near borders between superpixels on different planes to the side
// to which they belong, of at most four. The pixels around vote, each for the
// plane that it has: the more alike their colours and the better they measured
// that plane. Measurements count where there is texture in the pixel itself,
// since elsewhere the window saw only the edge beside it. In the same way,
// pixels whose measurement lies off their plane are asked whether others of
// their colour measured that with texture.
// labels: of each superpixel, the number of its plane or -1.
RefinedBorders RefineBorders(const BorderInputs& inputs,
                             const std::vector<int>& labels,
                             const std::vector<Plane>& planes,
                             const BorderOptions& options,
                             Device& device);

// Takes the trust from the measurements of the map, by its ratings, in the
// pixels of the raster that are fattened.
void DistrustFattened(ImageView<const uint8_t> fattened,
                      ImageView<uint8_t> ratings,
                      Device& device);

}  // namespace tsar
