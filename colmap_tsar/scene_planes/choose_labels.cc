// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/choose_labels.h"

#include "colmap_tsar/device/working_bytes.h"
#include "colmap_tsar/scene_planes/border_costs.h"
#include "colmap_tsar/scene_planes/label_graph.h"

#include <cstddef>
#include <utility>

namespace tsar {

LabeledView ChooseLabels(const ObservedView& view,
                         std::vector<Plane> planes,
                         const Image<PlaneCost>& costs,
                         const Image<float>& votes,
                         const LabelOptions& options) {
  const ViewEvidence& evidence = *view.evidence;
  const int num_superpixels = evidence.NumSuperpixels();
  const int num_planes = static_cast<int>(planes.size());
  LabeledView result;
  result.planes = std::move(planes);
  result.labels.assign(static_cast<size_t>(num_superpixels), -1);
  result.evidence.assign(static_cast<size_t>(num_superpixels),
                         LabelEvidence::kNone);
  result.strengths.assign(static_cast<size_t>(num_superpixels), 0.f);
  if (num_planes == 0 || num_superpixels == 0) {
    return result;
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
      const float vote = votes.Empty() ? 0.f : votes(k, s);
      graph.unary.push_back(costs(k, s).cost + vote);
    }
    const auto i = static_cast<size_t>(s);
    graph.unary.push_back(
        UnlabelledCost(evidence.weights[i], num_pixels[i], options));
  }
  for (const SuperpixelBorder& border : evidence.borders) {
    graph.edges.push_back({border.first, border.second});
  }
  const BorderCosts border_costs(evidence,
                                 view.camera.GetIntrinsics(),
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
    result.labels[static_cast<size_t>(s)] = k;
    result.strengths[static_cast<size_t>(s)] = costs(k, s).strength;
    result.evidence[static_cast<size_t>(s)] =
        costs(k, s).explained > 0.f   ? LabelEvidence::kMeasured
        : costs(k, s).confirmed > 0.f ? LabelEvidence::kCarried
                                      : LabelEvidence::kGuessed;
  }
  return result;
}

int64_t ChooseLabelsMainBytes(int64_t num_superpixels, int num_planes) {
  constexpr int64_t kBordersPerSuperpixel = 3;
  const int64_t costs = BytesOf<float>(num_superpixels * (num_planes + 1));
  const int64_t depths_at_borders =
      BytesOf<float>(kBordersPerSuperpixel * num_superpixels * num_planes *
                     SuperpixelBorder::kNumPixels);
  return costs + depths_at_borders;
}

}  // namespace tsar
