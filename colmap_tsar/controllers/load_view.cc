// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/load_view.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/pipeline/unmatched_depths.h"
#include "colmap_tsar/workspace/map_io.h"

#include <filesystem>
#include <string>
#include <utility>

namespace tsar {
namespace {

MapType OtherType(MapType type) {
  return type == MapType::kGeometric ? MapType::kPhotometric
                                     : MapType::kGeometric;
}

// The exported costs of one type of map. COLMAP gives windows without texture
// and views that see nothing a cost without evidence.
PlanarMap ReadCosts(const std::filesystem::path& path, const ViewData& view) {
  PlanarMap costs = ReadPlanarMap(path);
  if (costs.channels != 2 || costs.width != view.depth.Width() ||
      costs.height != view.depth.Height()) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "has " + std::to_string(costs.channels) +
                          " channels of " + std::to_string(costs.width) + "x" +
                          std::to_string(costs.height) + ", but needs 2 of " +
                          std::to_string(view.depth.Width()) + "x" +
                          std::to_string(view.depth.Height()),
                      "write it anew with patch_match_stereo or delete it");
  }
  for (float& cost : costs.values) {
    if (!(cost >= 0.f && cost < kCostWithoutEvidence)) {
      cost = kUndefinedCost;
    }
  }
  return costs;
}

void SetCosts(const PlanarMap& costs, size_t pixel, ViewData* view) {
  view->min_cost.Data()[pixel] = costs.values[pixel];
  view->second_cost.Data()[pixel] =
      costs.values[pixel + view->depth.NumPixels()];
}

void DropCosts(size_t pixel, ViewData* view) {
  view->min_cost.Data()[pixel] = kUndefinedCost;
  view->second_cost.Data()[pixel] = kUndefinedCost;
}

bool IsValid(const ViewData& view, size_t pixel) {
  return view.depth.Data()[pixel] > 0.f &&
         !(view.normal.Data()[pixel] == Vec3f{});
}

// The map to refine, and its costs where they were exported.
ViewData ReadMaps(const Workspace& workspace, int image) {
  const MapType type = workspace.Type();
  DepthNormal maps = workspace.ReadOriginalMaps(image, type);
  ViewData view;
  view.depth = std::move(maps.depth);
  view.normal = std::move(maps.normal);
  view.num_not_finite = maps.num_not_finite;
  if (std::filesystem::exists(workspace.CostPath(image, type))) {
    const PlanarMap costs = ReadCosts(workspace.CostPath(image, type), view);
    view.min_cost =
        Image<float>(view.depth.Width(), view.depth.Height(), kUndefinedCost);
    view.second_cost = view.min_cost;
    for (size_t i = 0; i < view.depth.NumPixels(); ++i) {
      SetCosts(costs, i, &view);
      if (view.min_cost.Data()[i] == kUndefinedCost) {
        // The images say nothing about this depth: it follows from what is
        // around it, or from chance.
        view.depth.Data()[i] = 0.f;
        view.normal.Data()[i] = {};
      }
    }
  }
  return view;
}

// Takes the hypotheses of the other type where the map to refine has none.
void FillFromOtherType(const Workspace& workspace, int image, ViewData* view) {
  const MapType type = OtherType(workspace.Type());
  if (!workspace.HasMaps(image, type)) {
    return;
  }
  const DepthNormal other = workspace.ReadOriginalMaps(image, type);
  if (!other.depth.HasSizeOf(view->depth)) {
    throw Error::File(
        ErrorCode::kMismatch,
        workspace.DepthPath(image, type).string(),
        "is not of the size of the " + ToString(workspace.Type()) + " map",
        "run patch_match_stereo again for this image, or delete the file");
  }
  view->num_not_finite += other.num_not_finite;
  const bool has_costs = !view->min_cost.Empty();
  const bool is_filtered = type == MapType::kGeometric;
  PlanarMap costs;
  if ((has_costs || is_filtered) &&
      std::filesystem::exists(workspace.CostPath(image, type))) {
    costs = ReadCosts(workspace.CostPath(image, type), *view);
  }
  for (size_t i = 0; i < view->depth.NumPixels(); ++i) {
    if (IsValid(*view, i)) {
      continue;
    }
    if (is_filtered && !costs.values.empty() &&
        costs.values[i] == kUndefinedCost) {
      // Not measured: a planar prior filled it.
      continue;
    }
    view->depth.Data()[i] = other.depth.Data()[i];
    view->normal.Data()[i] = other.normal.Data()[i];
    if (!has_costs) {
      continue;
    }
    if (costs.values.empty()) {
      // The costs at hand are those of the hypothesis that COLMAP rejected.
      DropCosts(i, view);
    } else {
      SetCosts(costs, i, view);
    }
  }
}

// Where the map to refine has a hypothesis.
void MarkThoseToRefine(ViewData* view) {
  view->is_to_refine =
      Image<uint8_t>::Uninitialized(view->depth.Width(), view->depth.Height());
  for (size_t i = 0; i < view->depth.NumPixels(); ++i) {
    const bool is_valid = IsValid(*view, i);
    view->is_to_refine.Data()[i] = is_valid ? 1 : 0;
    view->num_depths_to_refine += is_valid ? 1 : 0;
  }
}

// At the size of the maps, with the camera of that size.
void ReadColor(const Workspace& workspace, int image, ViewData* view) {
  const int width = view->depth.Width();
  const int height = view->depth.Height();
  view->color = workspace.ReadImage(image, width, height);
  view->camera = workspace.Model().images[image].camera.Resized(width, height);
}

}  // namespace

ViewData LoadView(const Workspace& workspace, int image) {
  ViewData view = ReadMaps(workspace, image);
  MarkThoseToRefine(&view);
  FillFromOtherType(workspace, image, &view);
  for (size_t i = 0; i < view.depth.NumPixels(); ++i) {
    // COLMAP writes unit vectors; other lengths are rounding, or hostile.
    view.normal.Data()[i] = Normalized(view.normal.Data()[i]);
    if (view.normal.Data()[i] == Vec3f{}) {
      view.depth.Data()[i] = 0.f;
      view.is_to_refine.Data()[i] = 0;
    }
  }
  ReadColor(workspace, image, &view);
  return view;
}

ViewData LoadDepthAndColor(const Workspace& workspace, int image) {
  ViewData view;
  view.depth = workspace.ReadOriginalMaps(image, workspace.Type()).depth;
  ReadColor(workspace, image, &view);
  return view;
}

bool IsUnfiltered(const Workspace& workspace, int image) {
  return IsUnfiltered(
      workspace.ReadOriginalMaps(image, workspace.Type()).depth);
}

}  // namespace tsar
