// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/priors/align_prior.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/view/refine_observer.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/refined_maps.h"
#include "colmap_tsar/view/uploaded_view.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// What the stages of a single view found, in main memory.
struct MeasuredImage {
  EvidenceInputs inputs;
  Image<Rgb> color;                         // Of the raster of the inputs.
  Image<float> gray;                        // Of the same.
  Image<uint8_t> ratings;                   // See ViewEvidence::ratings.
  Camera camera;                            // Of the maps.
  std::shared_ptr<const DepthPrior> prior;  // Null: none.
};

struct RefineResult {
  RefinedMaps maps;
  std::map<std::string, double> seconds;  // Per stage.
  // Why the image should keep its maps; empty where it was refined.
  std::string reason_to_keep;
  PriorAssessment prior;
  // What was measured, and what was observed by it, where one of them and not
  // the maps was asked for.
  std::unique_ptr<MeasuredImage> measured;
  std::unique_ptr<ViewEvidence> evidence;
};

// The reason to keep an image's maps where nothing is left of them.
inline constexpr const char* kNothingReliable =
    "none of its depths is reliable";

// Takes one image through the stages of a single view. Reads nothing and writes
// nothing; the result is a function of the arguments, whatever the device's
// threads. image_id keys the random numbers. When it returns, the device has
// done all work. Sources may have been uploaded by another device of the same
// GPU. They are let go as soon as nothing needs them any more. observer: where
// given, is shown what the stages find, which changes nothing.
RefineResult RefineImage(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    uint32_t image_id,
    const RefineOptions& options,
    Device& device,
    StageObserver* observer = nullptr);

// Uploads the sources, too.
RefineResult RefineImage(const ViewData& reference,
                         const std::vector<const ViewData*>& sources,
                         uint32_t image_id,
                         const RefineOptions& options,
                         Device& device);

}  // namespace tsar
