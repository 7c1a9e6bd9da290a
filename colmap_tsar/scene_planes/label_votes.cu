// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene_planes/label_votes.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/base/disparity.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/pixel_groups.h"
#include "colmap_tsar/device/working_bytes.h"
#include "colmap_tsar/planes/world_plane.h"
#include "colmap_tsar/scene_planes/visibility_votes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tsar {
namespace {

// A superpixel of a source view: its plane, and how much that counts.
struct SourceLabel {
  int plane = -1;
  float weight = 0.f;
};

// A view that votes.
struct LabelSource {
  Intrinsics intrinsics;
  RelativePose from_reference;
  DepthResolution resolution;
  ImageView<const uint16_t> superpixels;
  const SourceLabel* labels;  // By superpixel.
  const Plane* planes;        // All of them, in this view's frame.
};

// Sums of the weights of views.
struct LabelVotes {
  float same = 0.f;
  float against = 0.f;
};

// Adds the view's vote on a point of a plane, in the reference camera's frame.
TSAR_HD inline void AddLabelVote(const LabelSource& source,
                                 int plane,
                                 const Vec3f& point,
                                 const LabelVoteOptions& options,
                                 LabelVotes* votes) {
  const Vec3f seen = source.from_reference * point;
  if (!(seen.z > 0.f)) {
    return;
  }
  float x = 0.f;
  float y = 0.f;
  source.intrinsics.Project(seen, &x, &y);
  // As floats, since far outside they do not fit into integers.
  if (!(x >= 0.f && y >= 0.f && x < source.superpixels.width - 0.5f &&
        y < source.superpixels.height - 0.5f)) {
    return;
  }
  const SourceLabel label = source.labels[source.superpixels(
      static_cast<int>(x + 0.5f), static_cast<int>(y + 0.5f))];
  if (label.plane < 0) {
    return;
  }
  if (label.plane == plane) {
    votes->same += label.weight;
    return;
  }
  const float labelled =
      source.planes[label.plane].Depth(source.intrinsics.Ray(x, y));
  if (!(labelled > 0.f)) {
    return;
  }
  const float gap = (seen.z - labelled) /
                    (labelled * source.resolution.RelativeDepthError(labelled));
  if (fabsf(gap) < options.max_gap) {
    votes->against += options.cost_of_rival * label.weight *
                      fminf(fabsf(gap) / options.full_gap, 1.f);
  } else if (gap < 0.f) {
    votes->against += options.cost_of_hiding * label.weight;
  }
}

struct LabelVoteKernel {
  const int* first_pixels;  // Of each superpixel, among `pixels`.
  const int* pixels;
  const Plane* planes;
  const LabelSource* sources;
  int num_sources;
  VoteSampling sampling;
  LabelVoteOptions options;
  int raster_width;
  Intrinsics intrinsics;
  ImageView<PlaneCost> costs;  // Column: plane, row: superpixel.

  TSAR_HD void operator()(int k, int s) const {
    const int begin = first_pixels[s];
    const int num_pixels = first_pixels[s + 1] - begin;
    if (num_pixels == 0) {
      return;
    }
    const int num_tests = sampling.NumTests(num_pixels);
    float sum = 0.f;
    for (int i = 0; i < num_tests; ++i) {
      const int pixel =
          pixels[begin + VoteSampling::Pixel(i, num_tests, num_pixels)];
      const Vec3f ray =
          intrinsics.Ray(pixel % raster_width, pixel / raster_width);
      const float depth = planes[k].Depth(ray);
      if (!(depth > 0.f)) {
        continue;
      }
      LabelVotes votes;
      for (int j = 0; j < num_sources; ++j) {
        AddLabelVote(sources[j], k, ray * depth, options, &votes);
      }
      sum += fminf(votes.against, options.max_against) -
             options.gain_of_same * fminf(votes.same, options.max_same);
    }
    costs(k, s).cost += sum * num_pixels / num_tests;
  }
};

std::vector<SourceLabel> MakeSourceLabels(const VotingLabels& labels,
                                          const LabelVoteOptions& options) {
  std::vector<SourceLabel> result(labels.planes.size());
  for (size_t s = 0; s < result.size(); ++s) {
    result[s] = {labels.planes[s],
                 options.guessed_weight +
                     (1.f - options.guessed_weight) * labels.strengths[s]};
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

PixelGroups GroupBySuperpixel(const ViewEvidence& evidence, Device& device) {
  Image<int> labels =
      Image<int>::Uninitialized(evidence.width, evidence.height);
  std::copy(
      evidence.superpixels.begin(), evidence.superpixels.end(), labels.begin());
  return GroupPixels(DeviceImage<int>(device, labels).View(),
                     evidence.NumSuperpixels(),
                     device);
}

}  // namespace

void AddLabelVotes(const std::vector<ObservedView>& views,
                   const std::vector<Plane>& planes,
                   const std::vector<VotingLabels>& labels,
                   const LabelVoteOptions& options,
                   Device& device,
                   Image<PlaneCost>* costs) {
  const ViewEvidence& evidence = *views[0].evidence;
  const PixelGroups groups = GroupBySuperpixel(evidence, device);
  const Buffer<Plane> device_planes(device, planes);
  std::vector<DeviceImage<uint16_t>> superpixels;
  std::vector<Buffer<SourceLabel>> source_labels;
  std::vector<Buffer<Plane>> source_planes;
  std::vector<LabelSource> sources;
  for (size_t j = 1; j < views.size(); ++j) {
    superpixels.emplace_back(device, views[j].evidence->superpixels);
    source_labels.emplace_back(device,
                               MakeSourceLabels(labels[j - 1], options));
    source_planes.emplace_back(
        device, MovePlanes(planes, views[0].camera, views[j].camera));
    sources.push_back({views[j].camera.GetIntrinsics(),
                       ComputeRelativePose(views[0].camera, views[j].camera),
                       views[j].evidence->resolution,
                       std::as_const(superpixels.back()).View(),
                       std::as_const(source_labels.back()).Data(),
                       std::as_const(source_planes.back()).Data()});
  }
  const Buffer<LabelSource> device_sources(device, sources);
  DeviceImage<PlaneCost> device_costs(device, *costs);
  ParallelFor(device,
              costs->Width(),
              costs->Height(),
              LabelVoteKernel{groups.begin.Data(),
                              groups.pixels.Data(),
                              device_planes.Data(),
                              device_sources.Data(),
                              static_cast<int>(sources.size()),
                              kPlaneSampling,
                              options,
                              evidence.width,
                              views[0].camera.GetIntrinsics(),
                              device_costs.View()});
  *costs = device_costs.ToHost();
}

int64_t AddLabelVotesWorkingBytes(int num_views,
                                  int64_t num_pixels,
                                  int64_t num_superpixels,
                                  int num_planes) {
  const int64_t sources =
      (num_views - 1) *
      (BytesOf<LabelSource>(1) + BytesOf<uint16_t>(num_pixels) +
       BytesOf<SourceLabel>(num_superpixels) + BytesOf<Plane>(num_planes));
  const int64_t costs = BytesOf<PlaneCost>(num_superpixels * num_planes);
  const int64_t grouping = BytesOf<int>(num_pixels) +
                           GroupPixelsWorkingBytes(num_pixels, num_superpixels);
  return std::max(grouping,
                  PixelGroupsBytes(num_pixels, num_superpixels) + sources +
                      BytesOf<Plane>(num_planes) + costs);
}

}  // namespace tsar
