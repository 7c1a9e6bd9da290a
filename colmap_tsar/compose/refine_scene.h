// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/view/refine_observer.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/uploaded_view.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace tsar {

// The first and the last of the steps by which an image is refined together
// with all others. The first takes it through the stages of a single view and
// keeps their results. From these, the steps of find_scene.h make the planes of
// the scene, with which the last step composes its map.

// The first step in two parts: MeasureImage runs the stages, and its result
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

// Composes the reference's map from the planes and surfaces that were found in
// it. The evidence of the reference must have all its parts. sources: for
// RefineOptions::photometric; none where the map was judged at a smaller size.
// observer: as in RefineImage.
RefineResult ComposeImage(
    const ViewData& reference,
    const std::vector<std::shared_ptr<const UploadedView>>& sources,
    const std::vector<ObservedView>& views,
    const FoundScene& found,
    const RefineOptions& options,
    Device& device,
    StageObserver* observer = nullptr);

// The options with which ComposeImage() composes these views: the noise of
// their measurements sets the tolerance at planes.
ComposeSceneOptions MakeCompositionOptions(
    const std::vector<ObservedView>& views);

}  // namespace tsar
