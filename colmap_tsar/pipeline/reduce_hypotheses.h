// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/pipeline/device_views.h"

#include <cstdint>

namespace tsar {

// The hypotheses of ReduceView(), of a view in the device's memory.
// is_to_refine: ViewData::is_to_refine, in host memory. Beside the result,
// takes a byte of the device's memory for each pixel of the view.
DepthNormalImages ReduceHypotheses(const DeviceReference& view,
                                   const Image<uint8_t>& is_to_refine,
                                   int factor,
                                   Device& device);

}  // namespace tsar
