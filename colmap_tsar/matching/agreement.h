// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/views.h"

#include <cstdint>

namespace tsar {

struct AgreementOptions {
  // The largest reprojection error of an agreeing source after forward and
  // backward reprojection, in pixels of the map: the limit of COLMAP's fusion.
  float max_reprojection_error = 2.f;
  // The largest depth error of an agreeing source, as a fraction of depth.
  float max_depth_error = 0.01f;
};

// For each pixel, the number of sources whose depth maps agree with its depth
// by forward and backward reprojection; at most 255.
DeviceImage<uint8_t> CountAgreeingSources(const ReferenceView& reference,
                                          const Buffer<SourceView>& sources,
                                          const AgreementOptions& options,
                                          Device& device);

}  // namespace tsar
