// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/label_view.h"

#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/planes/world_plane.h"
#include "colmap_tsar/scene_planes/border_costs.h"
#include "colmap_tsar/scene_planes/label_votes.h"
#include "colmap_tsar/scene_planes/plane_costs.h"

#include <algorithm>
#include <cstddef>

namespace tsar {
namespace {

// Of the superpixel with label k, which costs this much without a plane.
LabelQuality RateLabel(const Image<PlaneCost>& costs,
                       int superpixel,
                       int k,
                       float unlabelled_cost,
                       float num_pixels) {
  float next_best = unlabelled_cost;
  for (int other = 0; other < costs.Width(); ++other) {
    if (other != k) {
      next_best = std::min(next_best, costs(other, superpixel).cost);
    }
  }
  const PlaneCost& cost = costs(k, superpixel);
  LabelQuality quality;
  quality.explained = ByteOf<0, 1>(cost.explained);
  quality.strength = ByteOf<0, 1>(cost.strength);
  quality.confirmed = ByteOf<0, 1>(cost.confirmed);
  quality.uncertainty = ByteOf<0, 1>(cost.uncertainty);
  quality.margin =
      ByteOf<-1, 2>((next_best - cost.cost) / std::max(num_pixels, 1.f));
  return quality;
}

}  // namespace

LabeledView LabelView(const std::vector<ObservedView>& views,
                      const DiscoveredPlanes& discovered,
                      const PlaneSupport& support,
                      const LabelOptions& options,
                      Device& device,
                      const std::vector<VotingLabels>& source_labels) {
  const ViewEvidence& evidence = *views[0].evidence;
  const int num_superpixels = evidence.NumSuperpixels();
  const int num_planes = static_cast<int>(discovered.planes.size());
  LabeledView result;
  result.labels.assign(static_cast<size_t>(num_superpixels), -1);
  result.evidence.assign(static_cast<size_t>(num_superpixels),
                         LabelEvidence::kNone);
  result.qualities.assign(static_cast<size_t>(num_superpixels), {});
  result.strengths.assign(static_cast<size_t>(num_superpixels), 0.f);
  if (num_planes == 0 || num_superpixels == 0) {
    return result;
  }
  for (const ScenePlane& found : discovered.planes) {
    result.planes.push_back(ToCameraPlane(found.plane, views[0].camera));
  }
  Image<PlaneCost> costs =
      ComputePlaneCosts(views, result.planes, support, options, device);
  if (!source_labels.empty()) {
    AddLabelVotes(
        views, result.planes, source_labels, options.votes, device, &costs);
  }
  std::vector<float> num_pixels(static_cast<size_t>(num_superpixels), 0.f);
  for (const uint16_t label : evidence.superpixels) {
    ++num_pixels[label];
  }
  LabelGraph graph;
  graph.num_nodes = num_superpixels;
  graph.num_labels = num_planes + 1;
  for (int s = 0; s < num_superpixels; ++s) {
    for (int k = 0; k < num_planes; ++k) {
      graph.unary.push_back(costs(k, s).cost);
    }
    const auto i = static_cast<size_t>(s);
    graph.unary.push_back(
        UnlabelledCost(evidence.weights[i], num_pixels[i], options));
  }
  for (const SuperpixelBorder& border : evidence.borders) {
    graph.edges.push_back({border.first, border.second});
  }
  const BorderCosts border_costs(evidence,
                                 views[0].camera.GetIntrinsics(),
                                 evidence.resolution,
                                 result.planes,
                                 options.full_gap);
  graph.pairwise = [&](int edge, int a, int b) {
    return border_costs(edge, a, b);
  };
  const std::vector<int> labels = MinimizeByExpansion(graph, options.expansion);
  for (int s = 0; s < num_superpixels; ++s) {
    const int k = labels[static_cast<size_t>(s)];
    if (k == num_planes) {
      continue;
    }
    const auto i = static_cast<size_t>(s);
    result.labels[i] = k;
    result.qualities[i] =
        RateLabel(costs,
                  s,
                  k,
                  UnlabelledCost(evidence.weights[i], num_pixels[i], options),
                  num_pixels[i]);
    result.strengths[i] = costs(k, s).strength;
    result.evidence[i] = costs(k, s).explained > 0.f ? LabelEvidence::kMeasured
                         : costs(k, s).confirmed > 0.f
                             ? LabelEvidence::kCarried
                             : LabelEvidence::kGuessed;
  }
  return result;
}

}  // namespace tsar
