// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/choose_labels.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/scene/graph_cut/label_graph.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace tsar {

namespace {

// The pairwise cost between a plane and 'none', as a multiple of that between
// two planes far apart.
constexpr float kBorderToNone = 2.f;

// The pairwise costs of borders between superpixels; the last label is 'none'.
// Keeps references to the evidence and the planes.
class BorderCosts {
 public:
  // full_gap: see LabelOptions.
  BorderCosts(const ViewEvidence& evidence,
              const Intrinsics& intrinsics,
              const DepthResolution& resolution,
              const std::vector<Plane>& planes,
              float full_gap);

  // edge: the index of the border in the evidence.
  float operator()(int edge, int a, int b) const;

 private:
  const std::vector<SuperpixelBorder>& borders_;
  DepthResolution resolution_;
  const std::vector<Plane>& planes_;
  float full_gap_;
  // Rays of the pixels of each border. Depths along them are computed on
  // demand: most planes are too costly for both superpixels.
  std::vector<Vec3f> rays_;
};

BorderCosts::BorderCosts(const ViewEvidence& evidence,
                         const Intrinsics& intrinsics,
                         const DepthResolution& resolution,
                         const std::vector<Plane>& planes,
                         float full_gap)
    : borders_(evidence.borders),
      resolution_(resolution),
      planes_(planes),
      full_gap_(full_gap) {
  rays_.reserve(borders_.size() *
                static_cast<size_t>(SuperpixelBorder::kNumPixels));
  for (const SuperpixelBorder& border : borders_) {
    for (const int pixel : border.pixels) {
      rays_.push_back(
          intrinsics.Ray(pixel % evidence.width, pixel / evidence.width));
    }
  }
}

float BorderCosts::operator()(int edge, int a, int b) const {
  if (a == b) {
    return 0.f;
  }
  const float weight = borders_[static_cast<size_t>(edge)].weight;
  if (static_cast<size_t>(std::max(a, b)) == planes_.size()) {
    return kBorderToNone * weight;
  }
  const Plane& first = planes_[static_cast<size_t>(a)];
  const Plane& second = planes_[static_cast<size_t>(b)];
  const Vec3f* rays =
      rays_.data() + static_cast<size_t>(edge) * SuperpixelBorder::kNumPixels;
  float sum = 0.f;
  for (int i = 0; i < SuperpixelBorder::kNumPixels; ++i) {
    const float first_depth = first.Depth(rays[i]);
    const float second_depth = second.Depth(rays[i]);
    const float nearer = std::min(first_depth, second_depth);
    if (!(nearer > 0.f)) {
      sum += 1.f;
      continue;
    }
    const float gap = std::abs(first_depth - second_depth) /
                      (nearer * resolution_.RelativeDepthError(nearer));
    sum += std::min(gap / full_gap_, 1.f);
  }
  return weight * sum / SuperpixelBorder::kNumPixels;
}

// The quality of the chosen label. of_labels: the unary cost of each label, the
// last one being none.
LabelQuality ScoreLabel(const PlaneCost& cost,
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
        UnlabeledCost(evidence.weights[i], num_pixels[i], options));
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
        ScoreLabel(costs(k, s),
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
