// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

namespace tsar {

// An observed view with its pose in the world. The evidence must outlive it.
struct ObservedView {
  const ViewEvidence* evidence = nullptr;
  Camera camera;  // Camera of the evidence's raster.
};

// camera: of the view's image at any size; only the pose is taken from it.
ObservedView MakeObservedView(const ViewEvidence& evidence,
                              const Camera& camera);

}  // namespace tsar
