// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/scene_planes/bounding_creases.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/label_view.h"
#include "colmap_tsar/scene_planes/plane_costs.h"
#include "colmap_tsar/scene_planes/scene_model.h"

#include <cstdint>
#include <vector>

namespace tsar {

// What a view is labelled with where planes end at creases.
class CreaseLabels {
 public:
  // creases: those of planes that the view may be labelled with. Keeps
  // references to all but the view's camera.
  CreaseLabels(const ObservedView& view,
               const std::vector<ModelPlane>& planes,
               const std::vector<BoundingCrease>& creases);

  // The view's evidence without the planes of regions that reach beyond
  // creases: a region without an edge at the crease gets one plane on both
  // sides of it.
  ViewEvidence WithoutRegionsBeyond() const;

  // Adds to the costs of superpixels (row) on planes (column; numbers: in the
  // model) that lie beyond a crease: of the plane that ends there, and of
  // others that nothing speaks for, but for those that begin at another crease
  // and stand before the one that begins here. Those that begin here lose what
  // it costs them that nothing of them was measured, and cannot be elsewhere.
  // costs: of the evidence without regions beyond. votes: of their size, or
  // empty.
  void AddVotes(const std::vector<int>& numbers,
                const Image<PlaneCost>& costs,
                const LabelOptions& options,
                Image<float>* votes) const;

  // Marks superpixels beyond creases that got no plane. labels: of each
  // superpixel the plane, or -1.
  void MarkBounded(const std::vector<int>& labels,
                   std::vector<LabelEvidence>* evidence) const;

 private:
  // Whether the region there was given the plane, or there is none.
  bool MayCutRegion(size_t superpixel, const Plane& plane) const;

  const ViewEvidence& evidence_;
  const Camera camera_;
  const std::vector<ModelPlane>& planes_;
  const std::vector<BoundingCrease>& creases_;
  std::vector<Vec3f> rays_;        // The middle of each superpixel,
  std::vector<float> num_pixels_;  // and its size.
  // By crease and superpixel, where it lies beyond, the depth at which the
  // plane begins; 0 elsewhere.
  std::vector<std::vector<float>> limits_;
  // By superpixel, whether regions do not count there.
  std::vector<uint8_t> is_cut_;
};

}  // namespace tsar
