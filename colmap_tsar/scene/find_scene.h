// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/scene/adjustment/inverse_depth_error.h"
#include "colmap_tsar/scene/creases/bounding_creases.h"
#include "colmap_tsar/scene/discovery/discover_planes.h"
#include "colmap_tsar/scene/discovery/join_planes.h"
#include "colmap_tsar/scene/evidence/label_view.h"
#include "colmap_tsar/scene/evidence/scene_model.h"
#include "colmap_tsar/scene/labeling/label_inputs.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"
#include "colmap_tsar/scene/surfaces/curved_surfaces.h"
#include "colmap_tsar/scene/surfaces/seen_cylinders.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace tsar {

// The steps from the evidence of views to the planes of the scene that they
// share, and to what each view shows of these. All but the costs of labels are
// for CPUs, as MakeEvidence().

// The planes that some views measured, and which of them each superpixel did.
struct BlockOfScene {
  std::vector<MeasuredScenePlane> planes;
  // See DiscoveredPlanes.
  std::vector<std::vector<int>> assignment;
  std::optional<Eigen::Matrix3d> frame;
};

// How many scores of a candidate for a superpixel a block may have. Beyond
// that, some of the candidates would be left out.
inline constexpr size_t kMaxBlockScores = size_t{1} << 27;

// For a block of so many views.
DiscoverPlanesOptions BlockDiscoveryOptions(DiscoverPlanesOptions discovery,
                                            int num_views);

BlockOfScene ModelBlock(const std::vector<ObservedView>& views,
                        const RefineOptions& options,
                        Device& device);

// What a view was labelled with.
struct LabelsInModel {
  ViewLabels labels;
  std::vector<float> strengths;  // See LabeledView.
};

// A view, and what the model of the scene says of it so far.
struct ModelledView {
  ObservedView observed;
  // The plane of the model that each superpixel measured, or -1.
  const std::vector<int>* assignment = nullptr;
  // Null where no view has been labelled yet.
  const LabelsInModel* labels = nullptr;
};

// Has the work done with a device that has so much memory left for it.
using DeviceLender = std::function<void(
    int64_t num_bytes, const std::function<void(Device&)>& work)>;

// Labels the first view with planes of the model, of which those count that the
// views measured, and those that begin where one of these ends. The evidence of
// the first view has all its parts. costs: what these planes cost there
// whatever the others are labelled with, as an earlier call with the same views
// and planes left it; empty where there was none. The result has the same bits
// on every device.
LabelsInModel LabelInModel(const std::vector<ModelledView>& views,
                           const std::vector<ModelPlane>& planes,
                           const std::vector<BoundingCrease>& creases,
                           const RefineOptions& options,
                           const DeviceLender& lend_device,
                           Image<PlaneCost>* costs);

// Of the device that is lent. rasters: confident depths where there are no
// costs, superpixels where the others have been labelled.
int64_t LabelInModelWorkingBytes(const LabelingSize& size,
                                 const LabelInputs::Rasters& rasters);

// The planes of the scene that an image shows and where, and what is curved.
struct FoundScene {
  LabeledView labeled;
  // Of labeled.planes: in the model, and how well they are known here.
  std::vector<int> plane_numbers;
  std::vector<InverseDepthError> plane_errors;
  CurvedView curved;
  // For each source view, the plane of each of its superpixels, in its camera's
  // frame; invalid where it has none.
  std::vector<std::vector<Plane>> planes_of_sources;
  // Columns and pipes whose outlines the image shows. FindScene leaves them to
  // its caller, as it does their time.
  std::vector<SeenCylinder> cylinders;
  // That it took, per stage: "labels", "curved surfaces", "columns and pipes".
  std::map<std::string, double> seconds;
};

// views: that of the reference, then those that look at the same scene, in any
// order, the same one for the same bits. labels: of each.
FoundScene FindScene(const std::vector<ObservedView>& views,
                     const std::vector<ModelPlane>& planes,
                     const std::vector<const ViewLabels*>& labels,
                     const RefineOptions& options,
                     Device& device);

// A plane map names the first so many planes of the model, which are those of
// largest support: by one more than their numbers, in 16 bits.
inline constexpr int kMaxPlanesOfMap = std::numeric_limits<uint16_t>::max();

// What a plane map may say in each pixel of the raster: the plane that its
// superpixel was labelled with. 0 where there is none, or a curved surface, or
// one that plane maps cannot name.
Image<uint16_t> PlaneNumbers(const Image<uint16_t>& superpixels,
                             const FoundScene& found);

// The plane of each superpixel, in the camera's frame; invalid where it has
// none.
std::vector<Plane> PlanesOfSuperpixels(const LabeledView& labeled);

// Superpixels of curved surfaces get planes of their own, which touch the
// surface in their middle.
LabeledView FlattenSurfaces(const ObservedView& view,
                            LabeledView labeled,
                            const CurvedView& curved);

}  // namespace tsar
