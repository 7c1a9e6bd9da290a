// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/device/device.h"
#include "colmap_tsar/priors/align_prior.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/view/refine_options.h"
#include "colmap_tsar/view/refined_maps.h"
#include "colmap_tsar/view/view_data.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// The results of the stages of a single view, in main memory.
struct MeasuredImage {
  EvidenceInputs inputs;
  Image<Rgb> color;                         // On the raster of the inputs.
  Image<float> gray;                        // On the same raster.
  Image<uint8_t> noisy_gray;                // The same, not denoised.
  Image<uint8_t> flags;                     // See ViewEvidence::flags.
  Camera camera;                            // Camera of the maps.
  std::shared_ptr<const DepthPrior> prior;  // Null: none.
};

struct RefineResult {
  RefinedMaps maps;
  std::map<std::string, double> seconds;  // Per stage.
  // The reason to keep the image's maps; empty where it was refined.
  std::string reason_to_keep;
  PriorAssessment prior;
  // The measurements, and the evidence made of them, where one of these was
  // requested instead of the maps.
  std::unique_ptr<MeasuredImage> measured;
  std::unique_ptr<ViewEvidence> evidence;
};

// The reason to keep an image's maps if no refined depth is left.
inline constexpr const char* kNothingReliable =
    "none of its depths is reliable";

// That reason if these refined maps have no depth, and empty otherwise. With
// min_confidence, an empty map is a valid result.
std::string ReasonToKeep(const RefinedMaps& maps, const RefineOptions& options);

// Takes one image through the stages of a single view. It reads and writes no
// files; the result is a function of the arguments, for any number of the
// device's threads. image_id keys the random numbers. When it returns, the
// device has finished all work. Sources may have been uploaded by another
// device of the same GPU. They are released as soon as possible.
RefineResult RefineImage(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    uint32_t image_id,
    const RefineOptions& options,
    Device& device);

// The first two of the steps by which an image is refined together with all
// others; neither makes maps. ObserveImage takes the image through the stages
// of a single view, with the arguments of RefineImage, and keeps the
// measurements. MakeEvidence replaces these by the evidence, from which the
// steps of find_scene.h make the planes of the scene, with which the last step
// (compose_image.h) composes the map. MakeEvidence has little work for a GPU:
// with many images, it runs on a CPU while the GPU observes the next one.
RefineResult ObserveImage(
    const ViewData& reference,
    std::vector<std::shared_ptr<const UploadedView>> sources,
    uint32_t image_id,
    const RefineOptions& options,
    Device& device);
void MakeEvidence(const RefineOptions& options,
                  Device& device,
                  RefineResult* result);

}  // namespace tsar
