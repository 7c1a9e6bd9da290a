// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/choose_labels.h"

#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene_planes/border_costs.h"
#include "colmap_tsar/scene_planes/label_graph.h"
#include "colmap_tsar/scene_planes/superpixel_rays.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>

namespace tsar {
namespace {

// of_labels: what each label would cost the superpixel, the last one being
// none; chosen: one of them.
LabelQuality RateLabel(const PlaneCost& cost,
                       std::span<const float> of_labels,
                       int chosen,
                       float num_pixels) {
  float next_best = std::numeric_limits<float>::infinity();
  for (size_t k = 0; k < of_labels.size(); ++k) {
    if (static_cast<int>(k) != chosen) {
      next_best = std::min(next_best, of_labels[k]);
    }
  }
  LabelQuality quality;
  quality.explained = ByteOf<0, 1>(cost.explained);
  quality.strength = ByteOf<0, 1>(cost.strength);
  quality.confirmed = ByteOf<0, 1>(cost.confirmed);
  quality.uncertainty = ByteOf<0, 1>(cost.uncertainty);
  quality.margin =
      ByteOf<-1, 2>((next_best - of_labels[static_cast<size_t>(chosen)]) /
                    std::max(num_pixels, 1.f));
  return quality;
}

}  // namespace

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
  result.qualities.assign(static_cast<size_t>(num_superpixels), {});
  result.strengths.assign(static_cast<size_t>(num_superpixels), 0.f);
  if (num_planes == 0 || num_superpixels == 0) {
    return result;
  }
  const std::vector<float> num_pixels = CountPixels(evidence);
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
  graph.min_pairwise = 0.f;
  const std::vector<int> labels = MinimizeByExpansion(graph, options.expansion);
  for (int s = 0; s < num_superpixels; ++s) {
    const int k = labels[static_cast<size_t>(s)];
    if (k == num_planes) {
      continue;
    }
    const auto i = static_cast<size_t>(s);
    result.labels[i] = k;
    const auto num_labels = static_cast<size_t>(graph.num_labels);
    result.qualities[i] =
        RateLabel(costs(k, s),
                  {graph.unary.data() + i * num_labels, num_labels},
                  k,
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
