// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/run/store/workspace.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tsar {

// One view before and after its refinement. The maps have the same size; the
// image has the same aspect ratio.
struct ComparisonRow {
  std::string name;
  Image<Rgb> image;
  Image<float> before;  // Depth; 0 = none.
  Image<float> after;   // Depth; 0 = none.
  Image<Vec3f> normals_before;
  Image<Vec3f> normals_after;
  Image<uint8_t> provenance;  // See refined_maps.h.
};

// Width of one of the six columns, in pixels of the picture.
constexpr int kComparisonColumnWidth = 360;

// Draws a row per view: image, depth before and after, normals before and
// after, and the provenance of each depth of the result, with the share of
// pixels that have a depth, and a legend. Both depth maps of a row have the
// same color scale. Throws Error kMismatch (no rows, an empty raster, maps of
// different sizes) and those of ColorizeProvenance.
Image<Rgb> DrawComparison(const std::vector<ComparisonRow>& rows);

// At most `count` evenly spaced elements, including the first.
std::vector<int> PickEvenly(const std::vector<int>& values, int count);

// Reads the data of one refined image's row. Throws Error: kMismatch (the files
// differ in size, or the original is lost), and those of the readers.
ComparisonRow ReadComparisonRow(const Workspace& workspace, int image);

}  // namespace tsar
