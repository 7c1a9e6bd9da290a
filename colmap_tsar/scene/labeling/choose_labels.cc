// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/choose_labels.h"

#include "colmap_tsar/scene/evidence/plane_indices.h"
#include "colmap_tsar/scene/graph_cut/alpha_expansion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <span>

namespace tsar {
namespace {

// The pairwise cost between a plane and 'none', as a multiple of that between
// two planes far apart.
constexpr float kBorderToNone = 2.f;

// The distance in the image, in pixels, of a ray from the intersection of two
// planes: the difference of their inverse depths over its slope. Infinite where
// they are parallel in the image, or the ray does not meet both.
float DistanceToCrease(const InverseDepthPlane& a,
                       const InverseDepthPlane& b,
                       const Vec3f& ray,
                       const Intrinsics& intrinsics) {
  const Vec3f gap = a - b;
  const float slope = std::hypot(gap.x / intrinsics.fx, gap.y / intrinsics.fy);
  return Dot(a, ray) > 0.f && Dot(b, ray) > 0.f && slope > 0.f
             ? std::abs(Dot(gap, ray)) / slope
             : std::numeric_limits<float>::infinity();
}

// The pairwise costs of borders between superpixels; the last label is 'none'.
// Keeps references to the evidence.
class BorderCosts {
 public:
  // reach: see LabelOptions::crease_reach.
  BorderCosts(const ObservedView& view,
              const std::vector<Plane>& planes,
              float reach)
      : evidence_(*view.evidence),
        intrinsics_(view.camera.GetIntrinsics()),
        reach_(reach) {
    for (const Plane& plane : planes) {
      planes_.push_back(ToInverseDepth(plane));
    }
    for (const SuperpixelBorder& border : evidence_.borders) {
      for (const int pixel : border.pixels) {
        rays_.push_back(
            intrinsics_.Ray(pixel % evidence_.width, pixel / evidence_.width));
      }
    }
  }

  // edge: the index of the border in the evidence.
  float operator()(int edge, int a, int b) const {
    if (a == b) {
      return 0.f;
    }
    const float weight = evidence_.borders[edge].weight;
    if (std::max(a, b) == std::ssize(planes_)) {
      return kBorderToNone * weight;
    }
    constexpr int kNumPixels = SuperpixelBorder::kNumPixels;
    float sum = 0.f;
    for (const Vec3f& ray :
         std::span(rays_).subspan(edge * kNumPixels, kNumPixels)) {
      const float distance =
          DistanceToCrease(planes_[a], planes_[b], ray, intrinsics_);
      sum += std::min(distance / reach_, 1.f);
    }
    return weight * sum / kNumPixels;
  }

 private:
  const ViewEvidence& evidence_;
  const Intrinsics intrinsics_;
  float reach_;
  std::vector<InverseDepthPlane> planes_;
  std::vector<Vec3f> rays_;  // Of the pixels of each border.
};

// The unary cost of a superpixel without a plane.
float UnlabeledCost(const ViewEvidence& evidence,
                    int superpixel,
                    float num_pixels,
                    const LabelOptions& options) {
  float weight = evidence.weights[superpixel];
  if (!evidence.confirmed_pixels.empty()) {
    weight += options.confirmed_weight * evidence.confirmed_pixels[superpixel];
  }
  return options.cost_of_unexplained * weight +
         options.unlabeled_cost * std::max(num_pixels - weight, 0.f);
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
  quality.margin = ByteOf<-1, 2>((next_best - of_labels[chosen]) /
                                 std::max(num_pixels, 1.f));
  return quality;
}

}  // namespace

ViewLabels ChooseLabels(const ObservedView& view,
                        const std::vector<Plane>& planes,
                        const Image<PlaneCost>& costs,
                        const Image<float>& votes,
                        const LabelOptions& options) {
  const ViewEvidence& evidence = *view.evidence;
  const int num_superpixels = evidence.NumSuperpixels();
  const int num_planes = static_cast<int>(planes.size());
  ViewLabels result;
  result.planes.assign(num_superpixels, kNoPlane);
  result.origins.assign(num_superpixels, LabelOrigin::kNone);
  result.qualities.resize(num_superpixels);
  result.strengths.assign(num_superpixels, 0.f);
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
    graph.unary.push_back(UnlabeledCost(evidence, s, num_pixels[s], options));
  }
  for (const SuperpixelBorder& border : evidence.borders) {
    graph.edges.push_back({border.first, border.second});
  }
  graph.pairwise = BorderCosts(view, planes, options.crease_reach);
  graph.min_pairwise = 0.f;
  const std::vector<int> labels = MinimizeByExpansion(graph);
  const auto num_labels = static_cast<size_t>(graph.num_labels);
  for (int s = 0; s < num_superpixels; ++s) {
    const int k = labels[s];
    if (k == num_planes) {
      continue;
    }
    const PlaneCost& cost = costs(k, s);
    result.planes[s] = k;
    result.qualities[s] = ScoreLabel(
        cost, {&graph.unary[s * num_labels], num_labels}, k, num_pixels[s]);
    result.strengths[s] = cost.strength;
    result.origins[s] = cost.explained > 0.f   ? LabelOrigin::kMeasured
                        : cost.confirmed > 0.f ? LabelOrigin::kCarried
                                               : LabelOrigin::kGuessed;
  }
  return result;
}

}  // namespace tsar
