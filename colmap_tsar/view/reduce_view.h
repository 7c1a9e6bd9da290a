// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/block_depth.h"
#include "colmap_tsar/view/view_data.h"

#include <cstddef>

namespace tsar {

// The longest side at which views are judged. All criteria, such as windows of
// 11 pixels and reprojection errors within 2, are in pixels of the map. On maps
// of many megapixels such windows contain mostly noise, and depth errors, which
// do not shrink with the pixels, span several pixels. Larger maps are therefore
// reduced to the largest size on which the thresholds were measured (640 to
// 1280 pixels); smaller maps are judged unreduced.
constexpr int kMaxJudgingSide = 1280;

// The smallest integer factor, at least 1, that reduces the map's long side to
// at most max_side.
int ReductionFactor(int width, int height, int max_side = kMaxJudgingSide);

// The factor by which a map of one size was reduced to another; 0 if there is
// none.
int FactorBetween(int width, int height, int reduced_width, int reduced_height);

// The camera of the reduced view.
Camera ReduceCamera(const Camera& camera, int factor);

// The view with one pixel for each block of factor x factor pixels, truncated
// at the right and bottom border: ceil(width / factor) x ceil(height / factor)
// pixels. Rays go through the centers of full blocks. The color is the mean.
// The hypothesis is never an average, which would lie on no surface where a
// block shows two. It is that of the pixel with the (lower) median depth, if at
// least 7 of 8 pixels of the block (all of four) have depths within 0.5 % of
// its plane, which noise does not meet by chance; otherwise there is none. It
// is moved along its plane to the new ray. The exported costs are those of that
// pixel.
ViewData ReduceView(const ViewData& view, int factor);

// Computes ReduceView() while only some rows of the view are in memory.
class ViewReducer {
 public:
  // camera: that of the full view. has_costs: whether it has exported costs.
  ViewReducer(const Camera& camera, int factor, bool has_costs);

  // Adds the next rows of the view's maps, without colors: full blocks, except
  // at the view's end.
  void Add(const ViewData& rows);

  // Returns the reduced view after all rows were added. color: that of the full
  // view.
  ViewData Finish(const Image<Rgb>& color);

 private:
  // Sets the hypothesis of a block to that of a pixel of the rows.
  void Set(const ViewData& rows,
           const BlockDepth& blocks,
           ptrdiff_t pixel,
           int x,
           int y);

  const Camera camera_;
  const int factor_;
  ViewData reduced_;
  int num_rows_ = 0;  // Rows of the full view added so far.
};

}  // namespace tsar
