// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/plane_export/plane_polygon.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Geometry>

namespace tsar {

// The maps of one refined image that show the scene planes.
struct PlaneView {
  int image = 0;  // Index into the sparse model's images.
  Camera camera;  // At the common size of the maps.
  Image<float> depth;
  Image<uint8_t> provenance;
  Image<uint16_t> planes;  // 1 + the index of the plane, 0: none.
};

// The images that have a plane map of the workspace's type, ascending.
std::vector<int> FindPlaneViews(const Workspace& workspace);

// Throws kMismatch (sizes differ, nonexistent plane) and errors of the readers.
PlaneView ReadPlaneView(const Workspace& workspace, int image, int num_planes);

// Calls function(p, x, y, projection, hit) where depth and plane p agree.
template <typename Function>
void ForEachPlanePixel(const PlaneView& view,
                       const std::vector<PlaneCoordinates>& planes,
                       Function function) {
  // The largest relative gap: a depth of an edited map or a kept measurement
  // may be off its plane, and rays along the plane exaggerate that.
  constexpr double kMaxGap = 0.1;
  const std::vector<PlaneProjection> projections =
      ProjectionsOf(planes, view.camera);
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

// The part of a plane that a view sees.
struct PlaneSighting {
  int image = 0;  // Index into the sparse model's images.
  int64_t num_pixels = 0;
  bool is_on_normal_side = false;  // Of the camera center.
};

// The statistics of a plane over all views.
struct PlaneStatistics {
  int64_t num_pixels = 0;
  int64_t num_measured = 0;              // Pixels with measured depth.
  std::vector<PlaneSighting> sightings;  // By image.
  Eigen::AlignedBox2d box;               // Bounds of the pixel centers.
  // Numbers of pixels by the size of their footprints, in eighths of an octave.
  std::map<int, int64_t> footprints;

  // The median side length of a pixel's footprint; 0 without pixels.
  double MedianFootprint() const;
  // Whether more pixels see the plane from its normal's side than from behind.
  bool IsSeenFromNormalSide() const;
};

void AddStatistics(const PlaneView& view,
                   const std::vector<PlaneCoordinates>& planes,
                   std::vector<PlaneStatistics>* statistics);

}  // namespace tsar
