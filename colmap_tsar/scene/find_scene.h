// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/adjustment/inverse_depth_error.h"
#include "colmap_tsar/scene/creases/bounding_creases.h"
#include "colmap_tsar/scene/cylinders.h"
#include "colmap_tsar/scene/discovery/join_planes.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace tsar {

// The steps from the evidence of views to the planes of the scene, and to the
// labels of each view. All but the costs of labels run on CPUs.

// The largest number of scores (of a candidate for a superpixel) in a block.
// Beyond that, some of the candidates would be left out.
inline constexpr size_t kMaxBlockScores = size_t{1} << 27;

// The planes that a block of views measured. The caller sets its place in the
// scene.
PlaneBlock ModelBlock(const std::vector<ObservedView>& views,
                      const RefineOptions& options,
                      Device& device);

// A view, with its assignment to planes of the model and its labels so far.
struct ModeledView {
  ObservedView observed;
  // The plane of the model that each superpixel measured, or -1.
  const std::vector<int>* assignment = nullptr;
  // As indices of the model's planes; null where no view has been labeled yet.
  const ViewLabels* labels = nullptr;
};

// Runs the work on a device, and again on another one if its memory runs out.
using DeviceLender =
    std::function<void(const std::function<void(Device&)>& work)>;

// Labels the first view with planes of the model: those that the views
// measured, and those that begin where one of these ends. The evidence of the
// first view must have all its parts. costs: the costs of these planes without
// votes of other views, as set by an earlier call with the same views and
// planes; empty on the first call. The result has the same bits on every
// device.
ViewLabels LabelInModel(const std::vector<ModeledView>& views,
                        const std::vector<ModelPlane>& planes,
                        const std::vector<BoundingCrease>& creases,
                        const RefineOptions& options,
                        const DeviceLender& lend_device,
                        Image<PlaneCost>* costs);

// The planes, columns and pipes of the scene that an image shows, and where.
struct FoundScene {
  // In the image's camera's frame, their indices in the model, and their errors
  // in this view.
  std::vector<Plane> planes;
  std::vector<int> plane_indices;
  std::vector<InverseDepthError> plane_errors;
  ViewLabels labels;  // As indices of these planes.
  // For each source view, the plane of each of its superpixels, in its camera's
  // frame; invalid where it has none.
  std::vector<std::vector<Plane>> planes_of_sources;
  // Columns and pipes of the scene in the camera's frame; the caller of
  // FindScene sets them.
  std::vector<CameraCylinder> cylinders;
  // Seconds per stage: "labels".
  std::map<std::string, double> seconds;
};

// views: the reference, then its neighbors in any order; the same order gives
// the same bits. labels: of each view.
FoundScene FindScene(const std::vector<ObservedView>& views,
                     const std::vector<ModelPlane>& planes,
                     const std::vector<const ViewLabels*>& labels,
                     Device& device);

// The number of planes that a plane map can represent, those of the model with
// the largest support: it stores indices plus one, in 16 bits.
inline constexpr int kMaxPlanesOfMap = std::numeric_limits<uint16_t>::max();

// The values of a plane map on the raster: the index plus one of the plane that
// each pixel's superpixel was labeled with; 0 where there is none, or one that
// plane maps cannot represent.
Image<uint16_t> PlaneIds(const Image<uint16_t>& superpixels,
                         const FoundScene& found);

// The plane of each superpixel, in the camera's frame; invalid where it has
// none.
std::vector<Plane> PlanesOfSuperpixels(const FoundScene& found);

}  // namespace tsar
