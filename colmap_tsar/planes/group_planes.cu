// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/planes/group_planes.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/device/parallel_for.h"

#include <cmath>

namespace tsar {
namespace {

constexpr int kNumRefits = 4;
// The scale of the Cauchy weights as a share of the inliers' tolerance.
constexpr double kCauchyShare = 0.5;

// A group's samples: measured pixels, listed in raster order.
struct SampleList {
  const RayDepth* samples;
  const int* indices;
  int count;

  TSAR_HD const RayDepth& operator[](int i) const {
    return samples[indices[i]];
  }
};

struct FitKernel {
  const int* begin;
  const int* pixels;
  int* scratch;  // One element per grouped pixel.
  const RayDepth* samples;
  DisparityScale scale;
  GroupPlaneOptions options;
  GroupPlane* results;

  TSAR_HD void operator()(int64_t k) const {
    GroupPlane result;
    result.num_pixels = begin[k + 1] - begin[k];
    int* indices = scratch + begin[k];
    result.min_depth = INFINITY;
    for (int i = begin[k]; i < begin[k + 1]; ++i) {
      const float depth = samples[pixels[i]].z;
      if (depth > 0.f) {
        indices[result.num_samples++] = pixels[i];
        result.min_depth = fminf(result.min_depth, depth);
        result.max_depth = fmaxf(result.max_depth, depth);
      }
    }
    if (result.num_samples >= 3) {
      const SampleList list{samples, indices, result.num_samples};
      result.plane = Fit(list, static_cast<uint32_t>(k));
      if (result.plane.Valid()) {
        Describe(list, &result);
      }
    }
    results[k] = result;
  }

  // How well a plane explains the samples: each counts 1 - (distance /
  // tolerance)^2, so that the middle of a noisy surface scores best (MSAC).
  TSAR_HD float Score(const Plane& plane,
                      const SampleList& list,
                      int step) const {
    float score = 0.f;
    for (int i = 0; i < list.count; i += step) {
      const float ratio = RelativeDistance(plane, list[i]) /
                          options.tolerance.At(list[i].z, scale);
      score += ratio < 1.f ? 1.f - ratio * ratio : 0.f;
    }
    return score;
  }

  TSAR_HD Plane Fit(const SampleList& list, uint32_t group) const {
    Philox random(options.image_id, group, options.iteration);
    const int step = 1 + (list.count - 1) / options.max_scored_samples;
    Plane best;
    float best_score = 0.f;
    for (int h = 0; h < options.num_hypotheses; ++h) {
      const RayDepth& a = list[random.NextBelow(list.count)];
      const RayDepth& b = list[random.NextBelow(list.count)];
      const RayDepth& c = list[random.NextBelow(list.count)];
      const Plane plane =
          Plane::FromPoints(ToPoint(a), ToPoint(b), ToPoint(c));
      if (!plane.Valid()) {
        continue;
      }
      const float score = Score(plane, list, step);
      if (score > best_score) {
        best_score = score;
        best = plane;
      }
    }
    // The plane of three noisy points tilts; least squares on its inliers finds
    // those that it missed. Cauchy weights keep a second surface at the edge of
    // the tolerance from pulling the plane over.
    for (int round = 0; round < kNumRefits && best.Valid(); ++round) {
      PlaneRegression regression;
      for (int i = 0; i < list.count; ++i) {
        const float distance = RelativeDistance(best, list[i]);
        const float tolerance = options.tolerance.At(list[i].z, scale);
        if (distance < tolerance) {
          const double ratio = distance / (kCauchyShare * tolerance);
          regression.Add(list[i], 1.0 / (1.0 + ratio * ratio));
        }
      }
      best = regression.Solve();
    }
    return best;
  }

  TSAR_HD void Describe(const SampleList& list, GroupPlane* result) const {
    double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
    for (int i = 0; i < list.count; ++i) {
      const RayDepth& sample = list[i];
      const float distance = RelativeDistance(result->plane, sample);
      const float tolerance = options.tolerance.At(sample.z, scale);
      result->num_near += distance < 3.f * tolerance ? 1 : 0;
      if (distance < tolerance) {
        ++result->num_inliers;
        x += sample.x;
        y += sample.y;
        xx += static_cast<double>(sample.x) * sample.x;
        xy += static_cast<double>(sample.x) * sample.y;
        yy += static_cast<double>(sample.y) * sample.y;
      }
    }
    if (result->num_inliers < 3) {
      return;
    }
    const double n = result->num_inliers;
    xx = xx / n - x / n * (x / n);
    xy = xy / n - x / n * (y / n);
    yy = yy / n - y / n * (y / n);
    const double determinant = xx * yy - xy * xy;
    if (determinant > 0.0) {
      result->support = {static_cast<float>(x / n),
                         static_cast<float>(y / n),
                         static_cast<float>(yy / determinant),
                         static_cast<float>(-xy / determinant),
                         static_cast<float>(xx / determinant)};
    }
  }
};

}  // namespace

Buffer<GroupPlane> FitGroupPlanes(const PixelGroups& groups,
                                  ImageView<const RayDepth> samples,
                                  const DisparityScale& scale,
                                  const GroupPlaneOptions& options,
                                  Device& device) {
  Buffer<int> scratch(device, groups.pixels.Size());
  Buffer<GroupPlane> results(device, groups.NumGroups());
  ParallelFor(device,
              groups.NumGroups(),
              FitKernel{groups.begin.Data(),
                        groups.pixels.Data(),
                        scratch.Data(),
                        samples.data,
                        scale,
                        options,
                        results.Data()});
  return results;
}

}  // namespace tsar
