// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/region_planes.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/device/parallel_for_teams.h"

#include <cmath>
#include <utility>

namespace tsar {
namespace {

// The cosine of 10 degrees; surfaces within it count as parallel.
constexpr float kCosMaxAlignment = 0.985f;
constexpr uint32_t kFirstStream = 1000;
constexpr int kNumAlignmentRounds = 5;
// The least share of the core's inliers that must agree with an aligned plane.
constexpr float kMinAlignedShare = 0.8f;

// The sums of a weighted mean, reduced over a team.
struct WeightedSum {
  double value = 0.0;
  double weight = 0.0;

  TSAR_HD WeightedSum& operator+=(const WeightedSum& other) {
    value += other.value;
    weight += other.weight;
    return *this;
  }
  // weight must not be 0.
  TSAR_HD double Mean() const { return value / weight; }
};

// The part of a grown region that lies outside its core.
struct RimKernel {
  ImageView<const int> grown;
  ImageView<const int> core;
  TSAR_HD int operator()(int x, int y) const {
    return core(x, y) < 0 ? grown(x, y) : -1;
  }
};

// The samples that support a region's first plane; further planes must have the
// same.
enum class Carrier { kNone, kCore, kRim };

struct RegionState {
  Carrier carrier = Carrier::kNone;
  int num_inliers = 0;  // Inliers of the first plane.
};

struct ChooseKernel {
  const GroupPlane* core_fits;
  const GroupPlane* rim_fits;
  PixelGroupsView core_pixels;
  PixelGroupsView rim_pixels;
  const RayDepth* remaining;
  DepthResolution resolution;
  RegionPlaneOptions options;
  int slot;
  const RegionState* states;
  RegionState* next_states;
  SupportedPlane* planes;

  template <typename Team>
  TSAR_HD void operator()(const Team& team, int64_t k) const {
    const GroupPlane& core = core_fits[k];
    const GroupPlane& rim = rim_fits[k];
    const bool is_first = slot == 0;
    const RegionState state = is_first ? RegionState{} : states[k];
    const float min_inliers = options.min_further_share * state.num_inliers;
    // Without support of the previous plane, later rounds find none.
    RegionState next;
    SupportedPlane result;
    if ((is_first || state.carrier == Carrier::kCore) &&
        IsCarriedByCore(core) && core.num_inliers >= min_inliers) {
      result = {AlignedWithRim(team, core, rim, k), core.support};
      next = is_first ? RegionState{Carrier::kCore, core.num_inliers} : state;
    } else if ((is_first || state.carrier == Carrier::kRim) &&
               IsCarriedByRim(rim) && rim.num_inliers >= min_inliers &&
               (!is_first ||
                MeanRimGap(team, rim.plane, k) < options.max_boundary_error)) {
      result = {rim.plane, rim.support};
      next = is_first ? RegionState{Carrier::kRim, rim.num_inliers} : state;
    }
    if (team.IsLeader()) {
      next_states[k] = next;
      planes[k * kMaxPlanesPerRegion + slot] = result;
    }
  }

  // Inliers lie within one tolerance, the samples beside them within the next
  // two: at equal density there are twice as many of the latter.
  TSAR_HD bool IsCarriedByCore(const GroupPlane& fit) const {
    return fit.plane.Valid() && fit.num_inliers >= options.min_samples &&
           2.f * fit.num_inliers >=
               options.min_core_contrast * (fit.num_near - fit.num_inliers);
  }

  TSAR_HD bool IsCarriedByRim(const GroupPlane& fit) const {
    return fit.plane.Valid() && fit.num_inliers >= options.min_samples &&
           fit.num_inliers >= options.min_rim_share * fit.num_samples;
  }

  // The plane with the normal of the rim and the offset of the core: objects on
  // a wall are parallel to it and textured, so that their many samples
  // determine the normal better than the few of the core. Kept if the core's
  // samples agree.
  template <typename Team>
  TSAR_HD Plane AlignedWithRim(const Team& team,
                               const GroupPlane& core,
                               const GroupPlane& rim,
                               int64_t k) const {
    if (!IsCarriedByRim(rim) || rim.num_inliers < core.num_inliers ||
        Dot(core.plane.normal, rim.plane.normal) < kCosMaxAlignment) {
      return core.plane;
    }
    const int num_pixels = core_pixels.Count(k);
    const Vec3f middle = {core.support.mean_x, core.support.mean_y, 1.f};
    Plane plane =
        Plane::FromPoint(middle, core.plane.Depth(middle), rim.plane.normal);
    for (int round = 0; round < kNumAlignmentRounds; ++round) {
      const WeightedSum offset = team.template Accumulate<WeightedSum>(
          num_pixels, [&](int i, WeightedSum* sum) {
            const RayDepth& sample = remaining[core_pixels.Pixel(k, i)];
            const float ratio = DistanceInTolerances(plane, sample);
            if (ratio < 1.f) {
              const double weight = 1.0 / (1.0 + 4.0 * ratio * ratio);
              *sum += {weight * -Dot(plane.normal, ToPoint(sample)), weight};
            }
          });
      if (!(offset.weight > 0.0)) {
        return core.plane;
      }
      plane.offset = static_cast<float>(offset.Mean());
    }
    const int num_inliers =
        team.template Accumulate<int>(num_pixels, [&](int i, int* sum) {
          const RayDepth& sample = remaining[core_pixels.Pixel(k, i)];
          *sum += DistanceInTolerances(plane, sample) < 1.f ? 1 : 0;
        });
    return num_inliers >= kMinAlignedShare * core.num_inliers ? plane
                                                              : core.plane;
  }

  // The distance of a sample from the plane in tolerances; infinite without a
  // sample.
  TSAR_HD float DistanceInTolerances(const Plane& plane,
                                     const RayDepth& sample) const {
    return sample.z > 0.f
               ? RelativeDistance(plane, sample) /
                     options.ransac.tolerance.At(sample.z, resolution)
               : INFINITY;
  }

  // The mean depth gap of Eq. 16.
  template <typename Team>
  TSAR_HD float MeanRimGap(const Team& team,
                           const Plane& plane,
                           int64_t k) const {
    const WeightedSum gap = team.template Accumulate<WeightedSum>(
        rim_pixels.Count(k), [&](int i, WeightedSum* sum) {
          const RayDepth& sample = remaining[rim_pixels.Pixel(k, i)];
          if (sample.z > 0.f) {
            const float depth = plane.Depth({sample.x, sample.y, 1.f});
            *sum += {fminf(fabsf(depth - sample.z) / sample.z,
                           2.f * options.max_boundary_error),
                     1.0};
          }
        });
    return gap.weight > 0.0 ? static_cast<float>(gap.Mean()) : 0.f;
  }
};

// Removes the inliers of the plane just found before the next is sought.
struct RemoveInliersKernel {
  ImageView<const int> grown;
  const SupportedPlane* planes;
  int slot;
  PlaneTolerance tolerance;
  DepthResolution resolution;
  ImageView<RayDepth> remaining;

  TSAR_HD void operator()(int x, int y) const {
    const int label = grown(x, y);
    RayDepth& sample = remaining(x, y);
    if (label < 0 || !(sample.z > 0.f)) {
      return;
    }
    const Plane& plane = planes[label * kMaxPlanesPerRegion + slot].plane;
    if (plane.Valid() && RelativeDistance(plane, sample) <
                             2.f * tolerance.At(sample.z, resolution)) {
      sample = {};
    }
  }
};

}  // namespace

RegionPlanes FitRegionPlanes(const Regions& regions,
                             ImageView<const RayDepth> samples,
                             const DepthResolution& resolution,
                             const RegionPlaneOptions& options,
                             Device& device) {
  const ImageView<const int> labels = regions.labels.View();
  const int width = labels.width;
  const int height = labels.height;
  RegionPlanes result{
      GrowLabels(labels, options.rim_width, device),
      Buffer<SupportedPlane>(
          device, static_cast<size_t>(regions.count) * kMaxPlanesPerRegion)};
  Fill(device, result.planes.Data(), result.planes.Size(), SupportedPlane{});
  if (regions.count == 0) {
    return result;
  }
  DeviceImage<int> core = ShrinkLabels(labels, options.core_margin, device);
  if (!options.use_core) {
    Fill(device, core.View().data, core.View().NumPixels(), -1);
  }
  const DeviceImage<int> rim = MapPixels<int>(
      device, width, height, RimKernel{result.grown.View(), core.View()});
  const PixelGroups core_groups =
      GroupPixels(core.View(), regions.count, device);
  const PixelGroups rim_groups = GroupPixels(rim.View(), regions.count, device);

  Buffer<RegionState> states(device, regions.count);
  Buffer<RegionState> next_states(device, regions.count);
  DeviceImage<RayDepth> remaining(device, width, height);
  Copy(device, samples.data, samples.NumPixels(), remaining.View().data);
  for (int slot = 0; slot < options.max_planes; ++slot) {
    GroupPlaneOptions ransac = options.ransac;
    // Superpixels draw from the streams below kFirstStream.
    ransac.iteration = kFirstStream + 2 * slot;
    const Buffer<GroupPlane> core_fits = FitGroupPlanes(
        core_groups, remaining.View(), resolution, ransac, device);
    ++ransac.iteration;
    const Buffer<GroupPlane> rim_fits = FitGroupPlanes(
        rim_groups, remaining.View(), resolution, ransac, device);
    ParallelForTeams<256>(device,
                          regions.count,
                          ChooseKernel{core_fits.Data(),
                                       rim_fits.Data(),
                                       core_groups.View(),
                                       rim_groups.View(),
                                       remaining.View().data,
                                       resolution,
                                       options,
                                       slot,
                                       states.Data(),
                                       next_states.Data(),
                                       result.planes.Data()});
    std::swap(states, next_states);
    ParallelFor(device,
                width,
                height,
                RemoveInliersKernel{result.grown.View(),
                                    result.planes.Data(),
                                    slot,
                                    ransac.tolerance,
                                    resolution,
                                    remaining.View()});
  }
  return result;
}

}  // namespace tsar
