// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/regions/regions.h"

namespace tsar {

// Corrects the planes of the regions between edges by those of segments. In a
// segment, planes of one kind are contradicted where more of the samples that
// have one are further from it than max_gap, as a fraction of their depth, than
// nearer, and confirmed where fewer are. Where those of the regions are
// contradicted and those of the segment confirmed, the pixels of the segment
// take these, as far as they reach. All else stays: where edges suffice, a
// segmentation has no say, and a wrong one no effect.
// segments: of FindSegments(), with their planes. samples: z = 0 for none.
void TakePlanesOfSegments(const Regions& segments,
                          ImageView<const RayDepth> samples,
                          ImageView<const Plane> segment_planes,
                          float max_gap,
                          ImageView<Plane> region_planes,
                          Device& device);

}  // namespace tsar
