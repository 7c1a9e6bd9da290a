// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/pipeline/refine_image.h"
#include "colmap_tsar/pipeline/refine_options.h"
#include "colmap_tsar/pipeline/uploaded_view.h"
#include "colmap_tsar/pipeline/view_data.h"
#include "colmap_tsar/planes/discover_planes.h"
#include "colmap_tsar/planes/view_evidence.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tsar {

// The two steps by which an image is refined together with its neighbours. The
// first takes it through the stages of a single view and keeps what these
// found; the second needs that of the image and of its sources.

// Arguments as RefineImage. The result holds the evidence and no maps.
RefineResult ObserveImage(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    uint32_t image_id,
    const RefineOptions& options,
    Device& device);

// Finds the planes of the scene in the evidence of the views, the first of
// which is that of the reference and has all its parts, and composes the
// reference's map of them. The other views may be in any order, the same one
// for the same bits.
RefineResult ComposeImage(const ViewData& reference,
                          const std::vector<ObservedView>& views,
                          const RefineOptions& options,
                          Device& device);

}  // namespace tsar
