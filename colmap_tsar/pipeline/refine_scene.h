// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/pipeline/refine_image.h"
#include "colmap_tsar/pipeline/refine_observer.h"
#include "colmap_tsar/pipeline/refine_options.h"
#include "colmap_tsar/pipeline/uploaded_view.h"
#include "colmap_tsar/pipeline/view_data.h"
#include "colmap_tsar/scene_planes/curved_surfaces.h"
#include "colmap_tsar/scene_planes/discover_planes.h"
#include "colmap_tsar/scene_planes/label_view.h"
#include "colmap_tsar/scene_planes/view_evidence.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// The two steps by which an image is refined together with its neighbours. The
// first takes it through the stages of a single view and keeps what these
// found; the second needs that of the image and of its sources.

// The first step in two parts: the stages, for which the result holds what they
// measured, and what makes evidence of that; the result then holds the evidence
// and no maps. Arguments as RefineImage. The second part has little to do for a
// GPU: where many images are observed, it goes on a CPU while the GPU measures
// the next one.
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

// The planes of the scene around an image and where it shows them, and what is
// curved.
struct FoundScene {
  LabeledView labeled;
  CurvedView curved;
  std::map<std::string, double> seconds;  // That it took, per stage.
};

// In the evidence of the views, the first of which is that of the reference.
// The other views may be in any order, the same one for the same bits. For CPUs
// as MakeEvidence().
FoundScene FindScene(const std::vector<ObservedView>& views,
                     const RefineOptions& options,
                     Device& device);

// Composes the reference's map of the planes that were found in these views.
// The evidence of the reference has all its parts. observer: as in RefineImage.
RefineResult ComposeImage(const ViewData& reference,
                          const std::vector<ObservedView>& views,
                          const FoundScene& found,
                          const RefineOptions& options,
                          Device& device,
                          StageObserver* observer = nullptr);

// Finds them, too.
RefineResult ComposeImage(const ViewData& reference,
                          const std::vector<ObservedView>& views,
                          const RefineOptions& options,
                          Device& device);

}  // namespace tsar
