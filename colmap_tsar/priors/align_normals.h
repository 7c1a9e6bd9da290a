// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/priors/align_prior.h"

#include <vector>

namespace tsar {

// Averages a prior's normals over each superpixel, and sets the fields of
// `aligned` that are about normals. Their errors are measured where superpixels
// have a plane of their own and normals that agree. A prior that hardly
// explains the variation of these normals is dropped, unless its absolute
// errors are small, since the normals of a facade hardly vary.
//
// normals: see DepthPrior; may be empty. superpixels: labels, on a raster of
// any size that covers the same photo. planes: of superpixels; invalid where
// there is none. samples: as for AlignPrior, on the raster of superpixels; the
// planes of superpixels with few of them are too uncertain to be compared with.
void AlignNormals(const Image<Vec3f>& normals,
                  const Image<int>& superpixels,
                  const std::vector<Plane>& planes,
                  const Image<RayDepth>& samples,
                  AlignedPrior* aligned);

}  // namespace tsar
