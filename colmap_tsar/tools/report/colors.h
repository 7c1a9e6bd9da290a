// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

#include <array>
#include <cstdint>

namespace tsar {

// The depths at the ends of the color scale; 0 < nearest < farthest.
struct DepthRange {
  float nearest = 0.f;
  float farthest = 0.f;
};

// The range of the depths of both maps without the smallest and the largest 2
// %, since outliers may be thousands of times too large. Pixels of 0 (no depth)
// are ignored. If neither map has a depth, the range is arbitrary but valid.
DepthRange RobustDepthRange(const Image<float>& before,
                            const Image<float>& after);

// Colors depths, clamped to the range: near is red, far is blue, 0 is black.
Image<Rgb> ColorizeDepth(const Image<float>& depth, const DepthRange& range);

// Colors unit normals in the camera's frame: red, green and blue increase to
// the right, upwards and towards the camera; 0 (no normal) is black.
Image<Rgb> ColorizeNormals(const Image<Vec3f>& normals);

// Colors a confidence map: 1 is dark violet, 255 bright yellow, with green
// between them; 0 (no depth) is black.
Image<Rgb> ColorizeConfidence(const Image<uint8_t>& confidence);

// Draws each scene plane of a plane map in its fixed color; 0 (none) is black.
Image<Rgb> ColorizePlanes(const Image<uint16_t>& planes);

// The colors of the values of provenance maps; 0 (none) is black. For the
// color-blind, after Okabe and Ito; measured depths are gray.
inline constexpr std::array<Rgb, 8> kProvenanceColors = {{{0, 0, 0},
                                                          {190, 190, 190},
                                                          {86, 180, 233},
                                                          {240, 228, 66},
                                                          {213, 94, 0},
                                                          {0, 158, 115},
                                                          {204, 121, 167},
                                                          {0, 114, 178}}};

// The values must have a color.
Image<Rgb> ColorizeProvenance(const Image<uint8_t>& provenance);

}  // namespace tsar
