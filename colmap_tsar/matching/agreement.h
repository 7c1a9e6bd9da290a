// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

#include <cstdint>

namespace tsar {

// For each pixel, the number of sources whose depth maps agree with its depth
// by forward and backward reprojection; at most 255.
DeviceImage<uint8_t> CountAgreeingSources(const ReferenceView& reference,
                                          const SourceViews& sources,
                                          Device& device);

}  // namespace tsar
