// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/scene_planes/gather_evidence.h"
#include "colmap_tsar/scene_planes/view_evidence.h"

namespace tsar {

bool IsMeasured(const RayDepth& sample);

// The distance of a measurement from a plane, in units of the error that one
// pixel of disparity makes.
float Residual(const RayDepth& sample,
               const Plane& plane,
               const DepthResolution& resolution);

// The observation of each pixel, of confidence 0 where there is none: what was
// measured, and elsewhere the plane of the pixel's region. Needs the candidates
// and region_planes of the evidence, and sets its confident_depth.
Image<Observation> ObservePixels(const EvidenceInputs& inputs,
                                 const EvidenceOptions& options,
                                 ViewEvidence* evidence);

}  // namespace tsar
