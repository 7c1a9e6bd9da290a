// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/compose/depth_interval.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/matching/views.h"
#include "colmap_tsar/priors/align_prior.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/tools/stereo/stereo_options.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <vector>

namespace tsar {

// The planar prior (Xu and Tao, "Planar Prior Assisted PatchMatch Multi-View
// Stereo", AAAI 2020): between reliable depths, a textureless surface is
// probably planar.

// For each pixel, the plane of its triangle in the Delaunay triangulation of at
// most one depth for each small square of the image: the median, if there are
// enough. Invalid outside of all triangles. depth: z in the camera frame, 0 if
// unreliable.
Image<Plane> TriangulatePlanes(const Image<float>& depth,
                               const Intrinsics& intrinsics);

// The reference's depths that match well and that the depths of two sources (or
// the only one) confirm; the others become 0.
DeviceImage<float> FindReliableDepth(const ReferenceView& reference,
                                     const Buffer<SourceView>& sources,
                                     float window_radius,
                                     Device& device);

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

// Filling of textureless surfaces without measurements under the planar prior.
// Measured depths stay bit-identical, and filled ones have no evidence
// (kCostWithoutEvidence in the final maps), so that a refinement, which knows
// more of the scene's planes, does not treat them as measured.

// Fills pixels without a depth by that of their prior plane, if it lies in the
// range, and marks them by kUndefinedCost, which no measured pixel has: one
// without a defined cost has kCostWithoutEvidence. prior: of the maps' size.
void FillWithPrior(const Image<Plane>& prior,
                   const Intrinsics& intrinsics,
                   const DepthInterval& range,
                   StereoMaps* maps);

// Matches the pixels that FillWithPrior filled, with their depth and normal as
// prior, and keeps the depths that the sources' depths, including filled ones,
// confirm. Filled pixels have the min_cost kUndefinedCost.
StereoMaps MatchUnderPrior(const ViewData& reference,
                           const std::vector<const ViewData*>& sources,
                           const DepthInterval& range,
                           uint32_t stream,
                           const StereoOptions& options,
                           Device& device);

}  // namespace tsar
