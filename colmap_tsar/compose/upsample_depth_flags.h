// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/view/device_views.h"

#include <cstdint>

namespace tsar {

// Upsamples ViewEvidence::flags of a view reduced by any factor to the pixels
// of the map. A pixel gets the flags of the reduced pixel that covers it, if
// its own depth lies on the plane of the hypothesis judged there; otherwise
// those of the nearest of the eight pixels around for which this holds, since
// no depth represents a block across an edge; and 0 if there is none. The
// tolerance is half of RelativeDepthError() of the judged map, and at least 0.3
// % of the depth. A factor of 1 leaves the flags unchanged. view: the reference
// in the device's memory. Throws kMismatch if it is of another map.
DeviceImage<uint8_t> UpsampleDepthFlags(const ViewEvidence& evidence,
                                        const DeviceReference& view,
                                        Device& device);

// The MeasurementFlags of each pixel. trusted: nonzero where its depth is
// trusted. confirmations: its Confirmation; may be empty.
DeviceImage<uint8_t> PackFlags(ImageView<const uint8_t> trusted,
                               ImageView<const uint8_t> confirmations,
                               Device& device);

// The hypotheses of ReduceView(), of a view in the device's memory.
DepthNormalImages ReduceHypotheses(const DeviceReference& view,
                                   int factor,
                                   Device& device);

}  // namespace tsar
