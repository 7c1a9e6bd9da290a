// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tsar {

// The depths, in the units of the maps, that the two ends of the color scale
// stand for; 0 < nearest < farthest.
struct DepthRange {
  float nearest = 0.f;
  float farthest = 0.f;
};

// The range that holds the depths of both maps but for the smallest and the
// largest 2 %: wrong depths may be thousands of times too large, and would
// leave one color for everything else. Pixels that are 0 (no depth) do not
// count. Any range, where neither map has a depth.
DepthRange RobustDepthRange(const Image<float>& before,
                            const Image<float>& after);

// Near is red, far is blue, 0 is black. Depths outside of the range have the
// color of its end.
Image<Rgb> ColorizeDepth(const Image<float>& depth, const DepthRange& range);

// A color for each label, always the same one; negative labels are black.
Image<Rgb> ColorizeLabels(const Image<int>& labels);

// The image with a bright line along the borders between labels. Both have the
// same size.
Image<Rgb> DrawLabelBorders(const Image<int>& labels, Image<Rgb> image);

// Red, green and blue grow with how far a normal points right, up and to the
// camera; 0 (no normal) is black. Normals in the camera's frame, of unit
// length.
Image<Rgb> ColorizeNormals(const Image<Vec3f>& normals);

// Shares of a range: 0 is dark violet, max (and all above) bright yellow, with
// green between them, so that brightness alone tells more from less. Where mask
// is given and 0 there is no value, which is black; it has the size of values.
Image<Rgb> ColorizeValues(const Image<float>& values,
                          float max,
                          const Image<float>* mask = nullptr);

// How one way of finding a pixel's depth is shown.
struct ProvenanceKind {
  std::string name;
  Rgb color;
};

// Indexed by the values of provenance maps; 0 is "none".
const std::vector<ProvenanceKind>& ProvenanceKinds();

// Throws Error kCorrupt for a value that is none of ProvenanceKinds().
Image<Rgb> ColorizeProvenance(const Image<uint8_t>& provenance);

}  // namespace tsar
