// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/square_hypothesis.h"
#include "colmap_tsar/view/view_data.h"

#include <cstddef>
#include <vector>

namespace tsar {

// Views are judged at one scale. All that tells a right depth from a wrong one,
// such as windows of 11 pixels and reprojections within 2, counts pixels of the
// map. On maps of many megapixels such windows show little but noise, and the
// errors of depths, which do not shrink with the pixels, span several of them.
// What is judged therefore has a long side of at most this, that of the
// largest images on which the thresholds were measured (640 to 1280 pixels);
// smaller maps are judged as they are.
constexpr int kMaxJudgingSide = 1280;

// The smallest number of map pixels, from 1 on, whose squares leave no more
// than max_side of them along the map's long side.
int ReductionFactor(int width, int height, int max_side = kMaxJudgingSide);

// The factor by which a map of one size was reduced to another; 0 where no
// factor does that.
int FactorBetween(int width, int height, int reduced_width, int reduced_height);

// The camera of the reduced view.
Camera ReduceCamera(const Camera& camera, int factor);

// The view with one pixel for each square of factor x factor pixels, those at
// the right and at the bottom cut off by the map's end: ceil(width / factor) x
// ceil(height / factor) of them. Rays go through the middle of whole squares.
// The colour is the mean. The hypothesis is never an average, which would lie
// on no surface where a square shows two: it is that of the pixel with the
// median depth (the lower one) of those from the map to refine, if at least 7
// of 8 pixels of the square (of four, all) have such depths and these lie
// within 0.5 % of its plane: what noise happens to agree on fills no squares.
// Otherwise it is of those from the other type under the same condition; or
// else there is none. It is taken along its plane to the new ray. The exported
// costs are those of that pixel.
ViewData ReduceView(const ViewData& view, int factor);

// ReduceView() of a view of which only some rows are in memory at a time.
class ViewReducer {
 public:
  // camera: of the whole view. has_costs: whether it has exported costs.
  ViewReducer(const Camera& camera, int factor, bool has_costs);

  // The next rows of the view's maps, without colours: whole squares, but where
  // the view ends.
  void Add(const ViewData& rows);

  // After all rows. color: of the whole view.
  ViewData Finish(const Image<Rgb>& color);

 private:
  // Makes the hypothesis of a square that of a pixel among the rows.
  void Set(const ViewData& rows,
           const SquareHypothesis& squares,
           ptrdiff_t pixel,
           int x,
           int y);

  const Camera camera_;
  const int factor_;
  ViewData reduced_;
  int num_rows_ = 0;  // Of the whole view, those that were added.
};

// Whether the reduced view has a depth in any pixel.
bool HasReducedDepth(const ViewData& view, int factor);

}  // namespace tsar
