// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/evidence/observed_view.h"
#include "colmap_tsar/scene/find_scene.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/view_data.h"

#include <vector>

namespace tsar {

// The last of the steps by which an image is refined together with all others,
// after ObserveImage(), MakeEvidence() and those of find_scene.h.

// Composes the reference's map from the planes and surfaces that were found in
// it. The evidence of the reference must have all its parts.
RefineResult ComposeImage(const ViewData& reference,
                          const std::vector<ObservedView>& views,
                          const FoundScene& found,
                          const RefineOptions& options,
                          Device& device);

// The options with which ComposeImage() composes these views: the noise of
// their measurements sets the tolerance at planes.
ComposeSceneOptions MakeCompositionOptions(
    const std::vector<ObservedView>& views);

}  // namespace tsar
