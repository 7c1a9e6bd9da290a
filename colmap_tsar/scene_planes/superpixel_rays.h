// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene_planes/view_evidence.h"

#include <vector>

namespace tsar {

// Of each superpixel of the evidence, the number of its pixels,
std::vector<float> CountPixels(const ViewEvidence& evidence);

// and the ray of their middle, in the camera's frame. intrinsics: of the
// raster.
std::vector<Vec3f> MiddleRays(const ViewEvidence& evidence,
                              const Intrinsics& intrinsics);

}  // namespace tsar
