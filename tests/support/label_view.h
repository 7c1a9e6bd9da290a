// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/scene/labeling/choose_labels.h"
#include "colmap_tsar/scene/labeling/label_inputs.h"
#include "colmap_tsar/scene/labeling/label_votes.h"
#include "colmap_tsar/scene/labeling/plane_costs.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <vector>

namespace tsar {

// Labels the first view with discovered planes on one device. source_labels: of
// the other views, as indices of these planes; or none.
inline ViewLabels LabelView(const std::vector<ObservedView>& views,
                            const DiscoveredPlanes& discovered,
                            const PlaneSupport& support,
                            const LabelOptions& options,
                            Device& device,
                            const std::vector<ViewLabels>& source_labels = {}) {
  std::vector<Plane> planes;
  for (const ScenePlane& found : discovered.planes) {
    planes.push_back(ToCameraPlane(found.plane, views[0].camera));
  }
  const LabelInputs inputs(views,
                           {/*confident_depth=*/true,
                            /*superpixels=*/!source_labels.empty()},
                           device);
  const Image<PlaneCost> costs =
      ComputePlaneCosts(inputs, planes, support, options, device);
  Image<float> votes;
  if (!source_labels.empty()) {
    votes = ComputeLabelVotes(inputs, planes, source_labels, device);
  }
  return ChooseLabels(views[0], planes, costs, votes, options);
}

}  // namespace tsar
