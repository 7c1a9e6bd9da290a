// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/planes/group_planes.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/device/parallel_for_teams.h"
#include "colmap_tsar/device/scan_and_sort.h"

#include <cmath>

namespace tsar {
namespace {

constexpr int kNumRefits = 4;
// The scale of the Cauchy weights as a share of the inliers' tolerance.
constexpr double kCauchyShare = 0.5;
// The largest score of a sample; scores are integers, whose sums do not depend
// on the order of the terms.
constexpr float kScoreUnit = 65536.f;

// A group's samples: measured pixels in raster order.
struct SampleList {
  const RayDepth* samples;
  int count;

  TSAR_HD const RayDepth& operator[](int i) const { return samples[i]; }
};

// The samples of all groups without the pixels that hold none.
struct GroupedSamples {
  PixelGroupsView pixels;
  const int* num_before;  // Samples before each grouped pixel.
  const RayDepth* samples;

  TSAR_HD SampleList operator[](int64_t group) const {
    const int first = num_before[pixels.begin[group]];
    return {samples + first, num_before[pixels.begin[group + 1]] - first};
  }
};

struct MarkSamplesKernel {
  PixelGroupsView groups;
  int num_groups;
  const RayDepth* samples;
  int* marks;

  TSAR_HD void operator()(int64_t i) const {
    const bool is_in_group = i < groups.begin[num_groups];
    marks[i] = is_in_group && samples[groups.pixels[i]].z > 0.f ? 1 : 0;
  }
};

struct GatherKernel {
  const int* pixels;
  const RayDepth* samples;
  const int* num_before;
  RayDepth* gathered;

  TSAR_HD void operator()(int64_t i) const {
    if (num_before[i + 1] > num_before[i]) {
      gathered[num_before[i]] = samples[pixels[i]];
    }
  }
};

// The plane of three samples drawn for a group's hypothesis.
TSAR_HD inline Plane DrawHypothesis(const SampleList& list,
                                    const GroupPlaneOptions& options,
                                    int64_t group,
                                    int hypothesis) {
  Philox random(options.image_id,
                static_cast<uint32_t>(group),
                options.iteration,
                options.seed);
  random.SkipToBlock(static_cast<uint32_t>(hypothesis));
  const RayDepth& a = list[random.NextBelow(list.count)];
  const RayDepth& b = list[random.NextBelow(list.count)];
  const RayDepth& c = list[random.NextBelow(list.count)];
  return Plane::FromPoints(ToPoint(a), ToPoint(b), ToPoint(c));
}

// The score of each hypothesis: each sample adds 1 - (distance / tolerance)^2,
// so that the middle of a noisy surface scores best (MSAC).
struct ScoreKernel {
  GroupedSamples groups;
  DepthResolution resolution;
  GroupPlaneOptions options;
  int* scores;

  template <typename Team>
  TSAR_HD void operator()(const Team& team, int64_t item) const {
    const int64_t group = item / options.num_hypotheses;
    const SampleList list = groups[group];
    const Plane plane =
        list.count >= 3
            ? DrawHypothesis(list,
                             options,
                             group,
                             static_cast<int>(item % options.num_hypotheses))
            : Plane{};
    if (!plane.Valid()) {
      if (team.IsLeader()) {
        scores[item] = 0;
      }
      return;
    }
    const int step = 1 + (list.count - 1) / options.max_scored_samples;
    const int score = team.template Accumulate<int>(
        (list.count + step - 1) / step, [&](int i, int* sum) {
          const RayDepth& sample = list[i * step];
          const float ratio = RelativeDistance(plane, sample) /
                              options.tolerance.At(sample.z, resolution);
          if (ratio < 1.f) {
            *sum += static_cast<int>((1.f - ratio * ratio) * kScoreUnit);
          }
        });
    if (team.IsLeader()) {
      scores[item] = score;
    }
  }
};

// The distribution of the samples about a plane.
struct PlaneSupport {
  int num_near = 0;
  int num_inliers = 0;
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0;

  TSAR_HD PlaneSupport& operator+=(const PlaneSupport& other) {
    num_near += other.num_near;
    num_inliers += other.num_inliers;
    x += other.x;
    y += other.y;
    xx += other.xx;
    xy += other.xy;
    yy += other.yy;
    return *this;
  }

  TSAR_HD SupportArea Area() const {
    const double n = num_inliers;
    const double var_x = xx / n - x / n * (x / n);
    const double cov = xy / n - x / n * (y / n);
    const double var_y = yy / n - y / n * (y / n);
    const double determinant = var_x * var_y - cov * cov;
    if (num_inliers < 3 || !(determinant > 0.0)) {
      return {};
    }
    return {static_cast<float>(x / n),
            static_cast<float>(y / n),
            static_cast<float>(var_y / determinant),
            static_cast<float>(-cov / determinant),
            static_cast<float>(var_x / determinant)};
  }
};

struct DepthRange {
  float min = INFINITY;
  float max = 0.f;

  TSAR_HD DepthRange& operator+=(const DepthRange& other) {
    min = fminf(min, other.min);
    max = fmaxf(max, other.max);
    return *this;
  }
};

// Refits each group's best hypothesis by least squares.
struct RefitKernel {
  GroupedSamples groups;
  const int* scores;
  DepthResolution resolution;
  GroupPlaneOptions options;
  GroupPlane* results;

  template <typename Team>
  TSAR_HD void operator()(const Team& team, int64_t group) const {
    const SampleList list = groups[group];
    GroupPlane result;
    result.num_pixels = groups.pixels.Count(group);
    result.num_samples = list.count;
    const DepthRange range = team.template Accumulate<DepthRange>(
        list.count, [&](int i, DepthRange* sum) {
          *sum += {list[i].z, list[i].z};
        });
    if (list.count > 0) {
      result.min_depth = range.min;
      result.max_depth = range.max;
    }
    Plane plane = BestHypothesis(list, group);
    // The plane of three noisy points is tilted; least squares on its inliers
    // recovers the inliers that it missed. Cauchy weights keep a second surface
    // at the edge of the tolerance from pulling the plane over.
    for (int round = 0; round < kNumRefits && plane.Valid(); ++round) {
      const PlaneRegression regression =
          team.template Accumulate<PlaneRegression>(
              list.count, [&](int i, PlaneRegression* sum) {
                const float distance = RelativeDistance(plane, list[i]);
                const float tolerance =
                    options.tolerance.At(list[i].z, resolution);
                if (distance < tolerance) {
                  const double ratio = distance / (kCauchyShare * tolerance);
                  sum->Add(list[i], 1.0 / (1.0 + ratio * ratio));
                }
              });
      plane = regression.Solve();
    }
    if (plane.Valid()) {
      const PlaneSupport support = Describe(team, plane, list);
      result.plane = plane;
      result.num_near = support.num_near;
      result.num_inliers = support.num_inliers;
      result.support = support.Area();
    }
    if (team.IsLeader()) {
      results[group] = result;
    }
  }

  // The first hypothesis of the highest score.
  TSAR_HD Plane BestHypothesis(const SampleList& list, int64_t group) const {
    const int* own_scores = scores + group * options.num_hypotheses;
    int best = -1;
    int best_score = 0;
    for (int h = 0; h < options.num_hypotheses; ++h) {
      if (own_scores[h] > best_score) {
        best_score = own_scores[h];
        best = h;
      }
    }
    return best >= 0 ? DrawHypothesis(list, options, group, best) : Plane{};
  }

  template <typename Team>
  TSAR_HD PlaneSupport Describe(const Team& team,
                                const Plane& plane,
                                const SampleList& list) const {
    return team.template Accumulate<PlaneSupport>(
        list.count, [&](int i, PlaneSupport* sum) {
          const RayDepth& sample = list[i];
          const float distance = RelativeDistance(plane, sample);
          const float tolerance = options.tolerance.At(sample.z, resolution);
          sum->num_near += distance < 3.f * tolerance ? 1 : 0;
          if (distance < tolerance) {
            ++sum->num_inliers;
            sum->x += sample.x;
            sum->y += sample.y;
            sum->xx += static_cast<double>(sample.x) * sample.x;
            sum->xy += static_cast<double>(sample.x) * sample.y;
            sum->yy += static_cast<double>(sample.y) * sample.y;
          }
        });
  }
};

}  // namespace

Buffer<GroupPlane> FitGroupPlanes(const PixelGroups& groups,
                                  ImageView<const RayDepth> samples,
                                  const DepthResolution& resolution,
                                  const GroupPlaneOptions& options,
                                  Device& device) {
  const int num_groups = groups.NumGroups();
  const size_t num_pixels = groups.pixels.Size();
  Buffer<int> marks(device, num_pixels);
  ParallelFor(
      device,
      static_cast<int64_t>(num_pixels),
      MarkSamplesKernel{groups.View(), num_groups, samples.data, marks.Data()});
  const Buffer<int> num_before = ExclusiveSum(marks.Data(), num_pixels, device);
  Buffer<RayDepth> gathered(device, num_pixels);
  ParallelFor(device,
              static_cast<int64_t>(num_pixels),
              GatherKernel{groups.pixels.Data(),
                           samples.data,
                           num_before.Data(),
                           gathered.Data()});
  const GroupedSamples grouped{
      groups.View(), num_before.Data(), gathered.Data()};
  Buffer<int> scores(device,
                     static_cast<size_t>(num_groups) * options.num_hypotheses);
  ParallelForTeams<32>(
      device,
      static_cast<int64_t>(scores.Size()),
      ScoreKernel{grouped, resolution, options, scores.Data()});
  Buffer<GroupPlane> results(device, num_groups);
  ParallelForTeams<256>(
      device,
      num_groups,
      RefitKernel{grouped, scores.Data(), resolution, options, results.Data()});
  return results;
}

}  // namespace tsar
