// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <vector>

namespace tsar {

// An observed view with its pose in the world. The evidence must outlive it.
struct ObservedView {
  const ViewEvidence* evidence = nullptr;
  Camera camera;  // Camera of the evidence's raster.
  // By superpixel, on which sides of creases it lies (FindSidesOfCreases);
  // empty where there are none.
  std::vector<int> sides = {};
};

// camera: of the view's image at any size; only the pose is taken from it.
inline ObservedView MakeObservedView(const ViewEvidence& evidence,
                                     const Camera& camera) {
  ObservedView view{&evidence, camera};
  view.camera.width = evidence.width;
  view.camera.height = evidence.height;
  view.camera.fx = evidence.intrinsics.fx;
  view.camera.fy = evidence.intrinsics.fy;
  view.camera.cx = evidence.intrinsics.cx;
  view.camera.cy = evidence.intrinsics.cy;
  return view;
}

}  // namespace tsar
