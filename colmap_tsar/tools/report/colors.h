// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

#include <cstdint>
#include <string>
#include <vector>

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

// Draws each label in its fixed color; negative labels are black.
Image<Rgb> ColorizeLabels(const Image<int>& labels);

// Colors unit normals in the camera's frame: red, green and blue increase to
// the right, upwards and towards the camera; 0 (no normal) is black.
Image<Rgb> ColorizeNormals(const Image<Vec3f>& normals);

// Colors values: 0 is dark violet, max (and all above) bright yellow, with
// green between them, so that brightness increases with the value. Pixels where
// mask (of the size of values, or not given) is 0 are black.
Image<Rgb> ColorizeValues(const Image<float>& values,
                          float max,
                          const Image<float>* mask = nullptr);

// The display of one value of provenance.
struct ProvenanceKind {
  std::string name;
  Rgb color;
};

// The kinds, indexed by the values of provenance maps; 0 is "none".
const std::vector<ProvenanceKind>& ProvenanceKinds();

// Throws Error kCorrupt for a value that is none of ProvenanceKinds().
Image<Rgb> ColorizeProvenance(const Image<uint8_t>& provenance);

}  // namespace tsar
