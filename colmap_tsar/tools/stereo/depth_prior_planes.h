// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/priors/align_prior.h"
#include "colmap_tsar/view/view_data.h"

namespace tsar {

// Aligns the depth prior of the reference, which must have one, with reliable
// depths on texture, and replaces planes of the triangulation by those of the
// prior: where there is none or the prior contradicts it, and only where the
// prior probably lies on the right surface, as for tsar_refine. Nothing is
// replaced where the prior is dropped. reliable_depth: of the map's size, 0
// where there is none. planes: of each pixel, invalid where there is none.
PriorAssessment UseDepthPrior(const ViewData& reference,
                              const DeviceImage<float>& reliable_depth,
                              Device& device,
                              Image<Plane>* planes);

}  // namespace tsar
