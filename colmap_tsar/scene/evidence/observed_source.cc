// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/observed_source.h"

namespace tsar {

ObservedSource MakeObservedSource(const ObservedView& reference,
                                  const ObservedView& source) {
  ObservedSource view;
  view.intrinsics = source.camera.GetIntrinsics();
  view.from_reference = ComputeRelativePose(reference.camera, source.camera);
  view.resolution = source.evidence->resolution;
  view.width = source.camera.width;
  view.height = source.camera.height;
  return view;
}

}  // namespace tsar
