// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/load_view.h"

#include "colmap_tsar/controllers/hypothesis_reader.h"
#include "colmap_tsar/pipeline/unmatched_depths.h"
#include "colmap_tsar/pipeline/uploaded_view.h"

#include <algorithm>
#include <utility>

namespace tsar {
namespace {

// With all maps undefined.
ViewData MakeMaps(int width, int height, bool has_costs) {
  ViewData view;
  view.depth = Image<float>::Uninitialized(width, height);
  view.normal = Image<Vec3f>::Uninitialized(width, height);
  view.is_to_refine = Image<uint8_t>::Uninitialized(width, height);
  if (has_costs) {
    view.min_cost = Image<float>::Uninitialized(width, height);
    view.second_cost = Image<float>::Uninitialized(width, height);
  }
  return view;
}

HypothesisPiece PieceOf(ViewData* view, size_t first, size_t count) {
  HypothesisPiece piece = {{view->depth.Data() + first, count},
                           {view->normal.Data() + first, count},
                           {view->is_to_refine.Data() + first, count},
                           {},
                           {}};
  if (!view->min_cost.Empty()) {
    piece.min_cost = {view->min_cost.Data() + first, count};
    piece.second_cost = {view->second_cost.Data() + first, count};
  }
  return piece;
}

Camera CameraOfMaps(const Workspace& workspace,
                    int image,
                    int width,
                    int height) {
  return workspace.Model().images[static_cast<size_t>(image)].camera.Resized(
      width, height);
}

// Of the map to refine.
Image<float> ReadOriginalDepth(const Workspace& workspace, int image) {
  DepthMapReader reader =
      workspace.OpenOriginalMaps(image, workspace.Type()).depth;
  auto depth =
      Image<float>::Uninitialized(reader.Size().width, reader.Size().height);
  ForEachPiece(depth.NumPixels(), [&](size_t first, size_t count) {
    reader.Read(first, {depth.Data() + first, count});
  });
  return depth;
}

}  // namespace

ViewData LoadView(const Workspace& workspace, int image) {
  HypothesisReader reader(workspace, image);
  const int width = reader.Width();
  const int height = reader.Height();
  ViewData view = MakeMaps(width, height, reader.HasCosts());
  ForEachPiece(reader.NumPixels(), [&](size_t first, size_t count) {
    reader.Read(first, PieceOf(&view, first, count));
  });
  view.num_depths_to_refine = reader.NumDepthsToRefine();
  view.num_not_finite = reader.NumNotFinite();
  view.is_unfiltered =
      IsUnfiltered(reader.NumDepths(), reader.NumPixelsInUse());
  view.color = workspace.ReadImage(image, width, height);
  view.camera = CameraOfMaps(workspace, image, width, height);
  return view;
}

ViewData LoadReducedView(const Workspace& workspace, int image, int max_side) {
  HypothesisReader reader(workspace, image);
  const int width = reader.Width();
  const int height = reader.Height();
  const int factor = ReductionFactor(width, height, max_side);
  if (factor == 1) {
    return LoadView(workspace, image);
  }
  ViewReducer reducer(
      CameraOfMaps(workspace, image, width, height), factor, reader.HasCosts());
  ViewData rows;
  for (int row = 0; row < height; row += factor) {
    const int num_rows = std::min(factor, height - row);
    if (rows.depth.Height() != num_rows) {
      rows = MakeMaps(width, num_rows, reader.HasCosts());
    }
    reader.Read(static_cast<size_t>(row) * static_cast<size_t>(width),
                PieceOf(&rows, 0, rows.depth.NumPixels()));
    reducer.Add(rows);
  }
  ViewData reduced = reducer.Finish(workspace.ReadImage(image, width, height));
  reduced.num_not_finite = reader.NumNotFinite();
  return reduced;
}

ViewData LoadDepthAndColor(const Workspace& workspace, int image) {
  ViewData view;
  view.depth = ReadOriginalDepth(workspace, image);
  const int width = view.depth.Width();
  const int height = view.depth.Height();
  ClearMasked(workspace.ReadMask(image, {width, height}), &view.depth);
  view.color = workspace.ReadImage(image, width, height);
  view.camera = CameraOfMaps(workspace, image, width, height);
  return view;
}

bool IsMaskedAway(const Workspace& workspace, int image) {
  if (!workspace.HasMask(image)) {
    return false;
  }
  Image<float> depth = ReadOriginalDepth(workspace, image);
  if (!HasDepth(depth)) {
    return false;
  }
  ClearMasked(workspace.ReadMask(image, {depth.Width(), depth.Height()}),
              &depth);
  return !HasDepth(depth);
}

}  // namespace tsar
