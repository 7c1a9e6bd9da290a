// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/view/device_views.h"
#include "colmap_tsar/view/superpixels/weighted_median.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>

namespace tsar {

// The hypotheses of a reduced view (ReduceView) and what came of judging them.
struct JudgedHypotheses {
  ImageView<const uint8_t> ratings;  // MeasurementRating
  DepthNormalViews hypotheses;
  Intrinsics intrinsics;
  int factor = 1;
};

// Ratings of the pixels of the map: each takes that of the reduced pixel that
// covers it, if its own depth lies on the plane of the hypothesis that was
// judged there; otherwise of the nearest of the eight pixels around for which
// this holds, since no depth stands for a square across an edge; and 0 where it
// holds for none. On the plane is what lies within half of
// RelativeDepthError() of the map that was judged, and within 0.3 % in any
// case. With a factor of 1 they are the ratings as they are.
// depth, intrinsics: of the map.
DeviceImage<uint8_t> LiftRatings(const JudgedHypotheses& judged,
                                 ImageView<const float> depth,
                                 const Intrinsics& intrinsics,
                                 const DepthResolution& resolution,
                                 Device& device);

// Of ViewEvidence::ratings, whatever it was reduced by. view: the reference in
// the device's memory. Throws kMismatch where it is of another map.
DeviceImage<uint8_t> LiftRatings(const ViewEvidence& evidence,
                                 const ViewData& reference,
                                 const DeviceReference& view,
                                 Device& device);

// The MeasurementRating of each pixel. trusted: other than 0 where its depth is
// trusted. confirmations: its Confirmation; may be empty.
DeviceImage<uint8_t> PackRatings(ImageView<const uint8_t> trusted,
                                 ImageView<const uint8_t> confirmations,
                                 Device& device);

// The hypotheses of ReduceView(), of a view in the device's memory.
// is_to_refine: ViewData::is_to_refine, in host memory. Beside the result,
// takes a byte of the device's memory for each pixel of the view.
DepthNormalImages ReduceHypotheses(const DeviceReference& view,
                                   const Image<uint8_t>& is_to_refine,
                                   int factor,
                                   Device& device);

}  // namespace tsar
