// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/observed_view.h"

namespace tsar {

ObservedView MakeObservedView(const ViewEvidence& evidence,
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
