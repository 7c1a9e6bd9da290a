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
                                size_t num_planes) {
  std::vector<double> measured(num_planes, 0.0);
  for (const ModeledView& view : views) {
    for (size_t s = 0; s < view.assignment->size(); ++s) {
      const int plane = (*view.assignment)[s];
      if (plane >= 0) {
        measured[plane] += std::min<double>(kMaxSuperpixelWeight,
                                            view.observed.evidence->weights[s]);
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
                         double tolerance) {
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
  return FindPlaneSupport(observed, near, tolerance);
}

}  // namespace

PlaneBlock ModelBlock(const std::vector<ObservedView>& views,
                      const RefineOptions& options,
                      Device& device) {
  DiscoverPlanesOptions discovery = MakeSceneOptions(options, views).discovery;
  discovery.max_planes = std::min(
      discovery.max_planes + kPlanesPerView * static_cast<int>(views.size()),
      kMaxBlockPlanes);
  discovery.max_scores = kMaxBlockScores;
  DiscoveredPlanes discovered =
      DiscoverPlanes(views, CollectCandidates(views), discovery, device);
  PlaneBlock block;
  block.planes = MeasureScenePlanes(views, discovered, discovery.tolerance);
  block.assignment = std::move(discovered.assignment);
  block.frame = discovered.frame;
  return block;
}

ViewLabels LabelInModel(const std::vector<ModeledView>& views,
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
  std::vector<int> indices = MeasuredPlanes(views, planes.size());
  const std::vector<BoundingCrease> bounding =
      BoundingCreasesOf(creases, &indices);
  if (!bounding.empty()) {
    observed[0].sides = FindSidesOfCreases(observed[0], planes, bounding);
  }
  const std::vector<int> new_indices = IndicesAmong(indices, planes.size());
  const std::vector<Plane> camera_planes =
      ToCameraPlanes(planes, indices, observed[0].camera);
  std::vector<ViewLabels> source_labels;
  for (size_t i = 1; i < views.size() && views[i].labels != nullptr; ++i) {
    ViewLabels& of_source = source_labels.emplace_back();
    of_source.planes = Renumber(views[i].labels->planes, new_indices);
    of_source.strengths = views[i].labels->strengths;
  }
  const LabelInputs::Rasters rasters = {/*confident_depth=*/costs->Empty(),
                                        /*superpixels=*/!source_labels.empty()};
  Image<float> votes;
  if (!indices.empty() && observed[0].evidence->NumSuperpixels() > 0 &&
      (rasters.confident_depth || rasters.superpixels)) {
    PlaneSupport support;
    if (rasters.confident_depth) {
      support = FindSupport(
          views, planes, indices, new_indices, scene.discovery.tolerance);
    }
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
  ViewLabels labels =
      ChooseLabels(observed[0], camera_planes, *costs, votes, scene.labels);
  labels.planes = Renumber(std::move(labels.planes), indices);
  return labels;
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
  found.plane_indices.assign(shown.begin(), shown.end());
  for (const int index : found.plane_indices) {
    found.plane_errors.push_back(ErrorInView(planes[index], camera));
  }
  found.planes = ToCameraPlanes(planes, found.plane_indices, camera);
  found.labels = labels;
  found.labels.planes =
      Renumber(labels.planes, IndicesAmong(found.plane_indices, planes.size()));
  for (size_t j = 1; j < views.size(); ++j) {
    std::vector<Plane>& of_source = found.planes_of_sources.emplace_back();
    for (const int plane : labels_of_views[j]->planes) {
      of_source.push_back(
          plane >= 0 ? ToCameraPlane(planes[plane].plane, views[j].camera)
                     : Plane{});
    }
  }
  timer.Finish("labels");
  return found;
}

Image<uint16_t> PlaneIds(const Image<uint16_t>& superpixels,
                         const FoundScene& found) {
  std::vector<uint16_t> of_superpixel;
  for (const int label : found.labels.planes) {
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

std::vector<Plane> PlanesOfSuperpixels(const FoundScene& found) {
  std::vector<Plane> planes;
  for (const int label : found.labels.planes) {
    planes.push_back(label >= 0 ? found.planes[label] : Plane{});
  }
  return planes;
}

}  // namespace tsar
