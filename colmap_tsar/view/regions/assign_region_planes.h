// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/plane_fit.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/view/regions/region_planes.h"
#include "colmap_tsar/view/regions/regions.h"

namespace tsar {

// The plane of each pixel of a region: of several planes, the one with most
// samples nearby. Invalid further from the plane's support than
// max_extrapolation, and outside the regions.
DeviceImage<Plane> AssignRegionPlanes(const Regions& regions,
                                      const RegionPlanes& planes,
                                      ImageView<const RayDepth> samples,
                                      const Intrinsics& intrinsics,
                                      const DepthResolution& resolution,
                                      const RegionPlaneOptions& options,
                                      Device& device);

// Corrects the planes of the regions between edges by those of segments. In a
// segment, either kind of plane is contradicted if more of its samples are
// further from it than max_gap, as a fraction of their depth, than nearer, and
// confirmed if fewer are. If the regions' planes are contradicted and the
// segment's confirmed, the pixels of the segment take the latter where valid.
// Else nothing changes: a segmentation has no effect where edges suffice, or if
// it is wrong. segments: result of FindSegments(), with their planes. samples:
// z = 0 for none.
void TakePlanesOfSegments(const Regions& segments,
                          ImageView<const RayDepth> samples,
                          ImageView<const Plane> segment_planes,
                          float max_gap,
                          ImageView<Plane> region_planes,
                          Device& device);

}  // namespace tsar
