// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/refine_image.h"

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace tsar {

// The evidence of an image; arguments as ObserveImage.
inline RefineResult MakeImageEvidence(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    uint32_t image_id,
    const RefineOptions& options,
    Device& device) {
  RefineResult result =
      ObserveImage(reference, std::move(sources), image_id, options, device);
  MakeEvidence(options, device, &result);
  return result;
}

}  // namespace tsar
