// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/find_scene.h"

#include "colmap_tsar/scene/discovery/plane_support.h"
#include "colmap_tsar/scene/evidence/plane_indices.h"
#include "colmap_tsar/scene/labeling/choose_labels.h"
#include "colmap_tsar/scene/labeling/crease_labels.h"
#include "colmap_tsar/scene/labeling/label_votes.h"
#include "colmap_tsar/scene/scene_options.h"
#include "colmap_tsar/view/planes/world_plane.h"
#include "colmap_tsar/view/stage_timer.h"

#include <algorithm>
#include <set>
#include <utility>

namespace tsar {
namespace {

// The least support of a plane in a view and its neighbors, in pixels of full
// confidence, for the view to be labeled with it.
constexpr double kMinMeasured = 50.0;
// The number of planes that each view adds to the limit of a block, and the
// largest limit: time grows with its square.
constexpr int kPlanesPerView = 8;
constexpr int kMaxBlockPlanes = 400;

// Indices of the model's planes that the views measured, in ascending order.
std::vector<int> MeasuredPlanes(const std::vector<ModeledView>& views,
                                size_t num_planes,
                                double max_weight) {
  std::vector<double> measured(num_planes, 0.0);
  for (const ModeledView& view : views) {
    for (size_t s = 0; s < view.assignment->size(); ++s) {
      const int plane = (*view.assignment)[s];
      if (plane >= 0) {
        measured[plane] +=
            std::min<double>(max_weight, view.observed.evidence->weights[s]);
      }
    }
  }
  std::vector<int> indices;
  for (size_t p = 0; p < num_planes; ++p) {
    if (measured[p] > kMinMeasured) {
      indices.push_back(static_cast<int>(p));
    }
  }
  return indices;
}

// The creases at which planes with these indices end. Adds the indices of the
// planes that begin there.
std::vector<BoundingCrease> BoundingCreasesOf(
    const std::vector<BoundingCrease>& creases, std::vector<int>* indices) {
  std::vector<BoundingCrease> result;
  std::set<int> all(indices->begin(), indices->end());
  for (const BoundingCrease& crease : creases) {
    if (std::ranges::binary_search(*indices, crease.plane)) {
      result.push_back(crease);
      all.insert(crease.beyond);
    }
  }
  indices->assign(all.begin(), all.end());
  return result;
}

// The planes with these indices, in the camera's frame.
std::vector<Plane> ToCameraPlanes(const std::vector<ModelPlane>& planes,
                                  const std::vector<int>& indices,
                                  const Camera& camera) {
  std::vector<Plane> result;
  for (const int index : indices) {
    result.push_back(ToCameraPlane(planes[index].plane, camera));
  }
  return result;
}

// The support of the planes with these indices.
PlaneSupport FindSupport(const std::vector<ModeledView>& views,
                         const std::vector<ModelPlane>& planes,
                         const std::vector<int>& indices,
                         const std::vector<int>& new_indices,
                         const PlaneSupportOptions& options) {
  DiscoveredPlanes near;
  for (const int index : indices) {
    const ModelPlane& plane = planes[index];
    near.planes.push_back({plane.plane, plane.support});
  }
  std::vector<ObservedView> observed;
  for (const ModeledView& view : views) {
    observed.push_back(view.observed);
    near.assignment.push_back(Renumber(*view.assignment, new_indices));
  }
  return FindPlaneSupport(observed, near, options);
}

}  // namespace

BlockOfScene ModelBlock(const std::vector<ObservedView>& views,
                        const RefineOptions& options,
                        Device& device) {
  const SceneOptions scene = MakeSceneOptions(options, views);
  DiscoverPlanesOptions discovery = scene.discovery;
  discovery.max_planes = std::min(
      discovery.max_planes + kPlanesPerView * static_cast<int>(views.size()),
      kMaxBlockPlanes);
  discovery.max_scores = kMaxBlockScores;
  DiscoveredPlanes discovered =
      DiscoverPlanes(views, CollectCandidates(views), discovery, device);
  return {MeasureScenePlanes(views, discovered, discovery, scene.support),
          std::move(discovered.assignment),
          discovered.frame};
}

LabelsInModel LabelInModel(const std::vector<ModeledView>& views,
                           const std::vector<ModelPlane>& planes,
                           const std::vector<BoundingCrease>& creases,
                           const RefineOptions& options,
                           const DeviceLender& lend_device,
                           Image<PlaneCost>* costs) {
  std::vector<ObservedView> observed;
  for (const ModeledView& view : views) {
    observed.push_back(view.observed);
  }
  const SceneOptions scene = MakeSceneOptions(options, observed);
  std::vector<int> indices =
      MeasuredPlanes(views, planes.size(), scene.discovery.max_weight);
  const std::vector<BoundingCrease> bounding =
      BoundingCreasesOf(creases, &indices);
  ViewEvidence cut;
  if (!bounding.empty()) {
    cut = CutAtCreases(observed[0], planes, bounding);
    observed[0].evidence = &cut;
  }
  const std::vector<int> new_indices = IndicesAmong(indices, planes.size());
  std::vector<Plane> camera_planes =
      ToCameraPlanes(planes, indices, observed[0].camera);
  std::vector<VotingLabels> source_labels;
  for (size_t i = 1; i < views.size() && views[i].labels != nullptr; ++i) {
    source_labels.push_back(
        {Renumber(views[i].labels->labels.planes, new_indices),
         views[i].labels->strengths});
  }
  const LabelInputs::Rasters rasters = {/*confident_depth=*/costs->Empty(),
                                        /*superpixels=*/!source_labels.empty()};
  Image<float> votes;
  if (!indices.empty() && observed[0].evidence->NumSuperpixels() > 0 &&
      (rasters.confident_depth || rasters.superpixels)) {
    const PlaneSupport support =
        rasters.confident_depth
            ? FindSupport(views, planes, indices, new_indices, scene.support)
            : PlaneSupport();
    lend_device([&](Device& device) {
      const LabelInputs inputs(observed, rasters, device);
      if (rasters.confident_depth) {
        *costs = ComputePlaneCosts(
            inputs, camera_planes, support, scene.labels, device);
      }
      if (rasters.superpixels) {
        votes = ComputeLabelVotes(inputs, camera_planes, source_labels, device);
      }
    });
  }
  if (!bounding.empty() && !costs->Empty()) {
    AddCreaseVotes(
        observed[0], planes, indices, bounding, scene.labels, costs, &votes);
  }
  LabeledView labeled = ChooseLabels(
      observed[0], std::move(camera_planes), *costs, votes, scene.labels);
  return {{Renumber(std::move(labeled.labels), indices),
           std::move(labeled.evidence),
           std::move(labeled.qualities)},
          std::move(labeled.strengths)};
}

FoundScene FindScene(const std::vector<ObservedView>& views,
                     const std::vector<ModelPlane>& planes,
                     const std::vector<const ViewLabels*>& labels_of_views,
                     Device& device) {
  FoundScene found;
  const ViewLabels& labels = *labels_of_views[0];
  StageTimer timer(device, &found.seconds);
  std::set<int> shown(labels.planes.begin(), labels.planes.end());
  shown.erase(kNoPlane);
  const Camera& camera = views[0].camera;
  const std::vector<int> indices(shown.begin(), shown.end());
  for (const int index : indices) {
    found.plane_errors.push_back(ErrorInView(planes[index], camera));
  }
  found.labeled.planes = ToCameraPlanes(planes, indices, camera);
  found.labeled.labels =
      Renumber(labels.planes, IndicesAmong(indices, planes.size()));
  found.labeled.evidence = labels.evidence;
  found.labeled.qualities = labels.qualities;
  for (size_t j = 1; j < views.size(); ++j) {
    std::vector<Plane>& of_source = found.planes_of_sources.emplace_back();
    for (const int plane : labels_of_views[j]->planes) {
      of_source.push_back(
          plane >= 0 ? ToCameraPlane(planes[plane].plane, views[j].camera)
                     : Plane{});
    }
  }
  found.plane_indices = indices;
  timer.Finish("labels");
  return found;
}

Image<uint16_t> PlaneIds(const Image<uint16_t>& superpixels,
                         const FoundScene& found) {
  std::vector<uint16_t> of_superpixel;
  for (const int label : found.labeled.labels) {
    const int id = label >= 0 ? found.plane_indices[label] + 1 : 0;
    of_superpixel.push_back(id <= kMaxPlanesOfMap ? static_cast<uint16_t>(id)
                                                  : uint16_t{0});
  }
  Image<uint16_t> ids(superpixels.Width(), superpixels.Height());
  for (size_t i = 0; i < ids.NumPixels(); ++i) {
    ids.Data()[i] = of_superpixel[superpixels.Data()[i]];
  }
  return ids;
}

std::vector<Plane> PlanesOfSuperpixels(const LabeledView& labeled) {
  std::vector<Plane> planes;
  for (const int label : labeled.labels) {
    planes.push_back(label >= 0 ? labeled.planes[label] : Plane{});
  }
  return planes;
}

}  // namespace tsar
