// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/plane_export/plane_polygon.h"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace tsar {

// The workspace whose planes are asked for. type: of the maps; if not given:
// geometric, or photometric where only those have planes. Errors as Workspace.
Workspace OpenWorkspaceWithPlanes(const std::filesystem::path& root,
                                  std::optional<MapType> type);

// What one refined image tells about the planes of the scene.
struct PlaneView {
  int image = 0;  // Index into the sparse model's images.
  Camera camera;  // Of the size of the maps, which is the same for all.
  Image<float> depth;
  Image<uint8_t> provenance;
  Image<uint16_t> planes;  // 1 + the number of the plane, 0: none.
};

// The images that have a plane map of the workspace's type, ascending.
std::vector<int> FindPlaneViews(const Workspace& workspace);

// Throws Error: kMismatch (maps of different sizes, a plane that there is not),
// and what the readers of the maps throw.
PlaneView ReadPlaneView(const Workspace& workspace, int image, int num_planes);

// Calls function(p, x, y, projection, hit) for each pixel that lies on a plane:
// one with a depth that its plane agrees with.
template <typename Function>
void ForEachPlanePixel(const PlaneView& view,
                       const std::vector<PlaneCoordinates>& planes,
                       Function function) {
  // Relative. A map that was edited since, or a measured depth that was kept,
  // may be off its plane; far off, a ray along the plane tells nothing.
  constexpr double kMaxGap = 0.1;
  std::vector<PlaneProjection> projections;
  projections.reserve(planes.size());
  for (const PlaneCoordinates& coordinates : planes) {
    projections.emplace_back(coordinates, view.camera);
  }
  PlaneProjection::Hit hit;
  for (int y = 0; y < view.planes.Height(); ++y) {
    for (int x = 0; x < view.planes.Width(); ++x) {
      const int p = view.planes(x, y) - 1;
      const double depth = view.depth(x, y);
      if (p >= 0 && depth > 0.0 && projections[p].Intersect(x, y, &hit) &&
          std::abs(hit.depth - depth) <= kMaxGap * depth) {
        function(p, x, y, projections[p], hit);
      }
    }
  }
}

}  // namespace tsar
