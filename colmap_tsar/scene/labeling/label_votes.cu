// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/label_votes.h"

#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene/evidence/observed_source.h"
#include "colmap_tsar/scene/evidence/render_source_depth.h"
#include "colmap_tsar/view/planes/world_plane.h"

#include <cmath>
#include <cstddef>

namespace tsar {
namespace {

// Costs are in pixels of the raster for each view of full weight, gaps in
// relative depths of one pixel of disparity.
//
// The gain of a pixel for each view with the same plane there,
constexpr float kGainOfSame = 0.1f;
// and its cost for each view with another plane within kMaxGap. The cost grows
// with the gap, up to kFullGap.
constexpr float kCostOfRival = 0.1f;
constexpr float kMaxGap = 6.f;
constexpr float kFullGap = 0.5f;
// The cost of lying further than that in front of a view's plane, which it
// would occlude, and the cost of lying behind surfaces that several views see
// in front of it.
constexpr float kCostOfHiding = 0.1f;
constexpr float kCostOfHidden = 0.2f;
// The weight of a label without measurements in its own view. One that all
// measurements agree on has weight 1 (ViewLabels::strengths).
constexpr float kGuessedWeight = 0.2f;
// Upper limits of the weight that gains, and of the cost of a pixel.
constexpr float kMaxSame = 3.f;
constexpr float kMaxAgainst = 3.f;
// The least number of views that see a surface in front: one may be wrong.
constexpr int kMinInFront = 2;
// The least strength of a label that occludes.
constexpr float kFirm = 0.5f;

// A superpixel of a source view: its plane, and the weight of that label.
struct SourceLabel {
  int plane = -1;
  float weight = 0.f;
};

// The labels of a source view.
struct SourceLabels {
  const SourceLabel* labels;  // By superpixel.
  const Plane* planes;        // All of them, in this view's frame.
  // The surface of its strong labels, rendered into the reference.
  ImageView<const float> front;
};

// Sums of the weights of views that agree, and of costs by those that do not.
struct LabelVotes {
  float same = 0.f;
  float against = 0.f;
};

// Adds the view's vote on a point of a plane, in the reference camera's frame.
TSAR_HD inline void AddLabelVote(const ObservedSource& source,
                                 const SourceLabels& labels,
                                 int plane,
                                 const Vec3f& point,
                                 LabelVotes* votes) {
  SeenPoint seen;
  if (!FindInSource(source, point, &seen)) {
    return;
  }
  const SourceLabel label =
      labels.labels[source.superpixels(seen.column, seen.row)];
  if (label.plane < 0) {
    return;
  }
  if (label.plane == plane) {
    votes->same += label.weight;
    return;
  }
  const float labeled =
      labels.planes[label.plane].Depth(source.intrinsics.Ray(seen.x, seen.y));
  if (!(labeled > 0.f)) {
    return;
  }
  const float gap = (seen.depth - labeled) /
                    (labeled * source.resolution.RelativeDepthError(labeled));
  if (fabsf(gap) < kMaxGap) {
    votes->against +=
        kCostOfRival * label.weight * fminf(fabsf(gap) / kFullGap, 1.f);
  } else if (gap < 0.f) {
    votes->against += kCostOfHiding * label.weight;
  }
}

struct LabelVoteKernel {
  PixelGroupsView pixels;  // By superpixel.
  const Plane* planes;
  const ObservedSource* sources;
  const SourceLabels* labels;
  int num_sources;
  VoteSampling sampling;
  int raster_width;
  Intrinsics intrinsics;
  ImageView<float> votes;  // Column: plane, row: superpixel.

  TSAR_HD void operator()(int k, int s) const {
    votes(k, s) = CostOfVotes(k, s);
  }

  TSAR_HD float CostOfVotes(int k, int s) const {
    const int num_pixels = pixels.Count(s);
    if (num_pixels == 0) {
      return 0.f;
    }
    const int num_tests = sampling.NumTests(num_pixels);
    float sum = 0.f;
    for (int i = 0; i < num_tests; ++i) {
      const int pixel =
          pixels.Pixel(s, VoteSampling::Pixel(i, num_tests, num_pixels));
      const Vec3f ray =
          intrinsics.Ray(pixel % raster_width, pixel / raster_width);
      const float depth = planes[k].Depth(ray);
      if (!(depth > 0.f)) {
        continue;
      }
      LabelVotes at_pixel;
      int num_in_front = 0;
      for (int j = 0; j < num_sources; ++j) {
        AddLabelVote(sources[j], labels[j], k, ray * depth, &at_pixel);
        num_in_front +=
            labels[j].front.data[pixel] < (1.f - kOtherSurface) * depth ? 1 : 0;
      }
      if (num_in_front >= kMinInFront) {
        at_pixel.against += kCostOfHidden * num_in_front;
      }
      sum += fminf(at_pixel.against, kMaxAgainst) -
             kGainOfSame * fminf(at_pixel.same, kMaxSame);
    }
    return sum * num_pixels / num_tests;
  }
};

std::vector<SourceLabel> MakeSourceLabels(const ViewLabels& labels) {
  std::vector<SourceLabel> result;
  for (size_t s = 0; s < labels.planes.size(); ++s) {
    result.push_back(
        {labels.planes[s],
         kGuessedWeight + (1.f - kGuessedWeight) * labels.strengths[s]});
  }
  return result;
}

std::vector<Plane> MovePlanes(const std::vector<Plane>& planes,
                              const Camera& from,
                              const Camera& to) {
  std::vector<Plane> result;
  for (const Plane& plane : planes) {
    result.push_back(
        plane.Valid() ? ToCameraPlane(ToWorldPlane(plane, from), to) : plane);
  }
  return result;
}

// Planes by superpixel; invalid where the label is not strong.
std::vector<Plane> FirmPlanes(const ViewLabels& labels,
                              const std::vector<Plane>& planes) {
  std::vector<Plane> result;
  for (size_t s = 0; s < labels.planes.size(); ++s) {
    const int plane = labels.planes[s];
    result.push_back(plane >= 0 && labels.strengths[s] >= kFirm ? planes[plane]
                                                                : Plane{});
  }
  return result;
}

}  // namespace

Image<float> ComputeLabelVotes(const LabelInputs& inputs,
                               const std::vector<Plane>& planes,
                               const std::vector<ViewLabels>& labels,
                               Device& device) {
  const std::vector<ObservedView>& views = inputs.Views();
  const ViewEvidence& evidence = *views[0].evidence;
  const Buffer<Plane> device_planes(device, planes);
  std::vector<Buffer<SourceLabel>> labels_of_sources;
  std::vector<Buffer<Plane>> planes_of_sources;
  std::vector<DeviceImage<float>> fronts;
  std::vector<SourceLabels> of_sources;
  for (size_t j = 1; j < views.size(); ++j) {
    labels_of_sources.emplace_back(device, MakeSourceLabels(labels[j - 1]));
    const std::vector<Plane> moved =
        MovePlanes(planes, views[0].camera, views[j].camera);
    planes_of_sources.emplace_back(device, moved);
    fronts.push_back(RenderSourceDepth(
        views[0],
        views[j],
        DepthOfPlanes(views[j], FirmPlanes(labels[j - 1], moved), device)
            .View(),
        device));
    of_sources.push_back({labels_of_sources.back().Data(),
                          planes_of_sources.back().Data(),
                          fronts.back().View()});
  }
  const Buffer<SourceLabels> device_labels(device, of_sources);
  DeviceImage<float> votes(
      device, static_cast<int>(planes.size()), evidence.NumSuperpixels());
  ParallelFor(device,
              votes.Width(),
              votes.Height(),
              LabelVoteKernel{inputs.Pixels(),
                              device_planes.Data(),
                              inputs.Sources(),
                              device_labels.Data(),
                              inputs.NumSources(),
                              kPlaneSampling,
                              evidence.width,
                              views[0].camera.GetIntrinsics(),
                              votes.View()});
  return votes.ToHost();
}

}  // namespace tsar
