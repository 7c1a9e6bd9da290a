// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/view/refine_observer.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/uploaded_view.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tsar {

// The first of the steps by which an image is refined together with all others.
// It takes the image through the stages of a single view and keeps their
// results. From these, the steps of find_scene.h make the planes of the scene,
// with which the last step (compose_image.h) composes its map.

// It has two parts: MeasureImage runs the stages, and its result
// holds the measurements; MakeEvidence replaces these by the evidence. Neither
// makes maps. Arguments are those of RefineImage. The second part has little
// work for a GPU: with many images, it runs on a CPU while the GPU measures the
// next one.
RefineResult MeasureImage(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    uint32_t image_id,
    const RefineOptions& options,
    Device& device,
    StageObserver* observer = nullptr);
void MakeEvidence(const RefineOptions& options,
                  Device& device,
                  RefineResult* result);

}  // namespace tsar
