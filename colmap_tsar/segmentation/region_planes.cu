// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/copy.h"
#include "colmap_tsar/device/fill.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/segmentation/region_planes.h"

#include <cmath>

namespace tsar {
namespace {

// Surfaces that differ by less than 10 degrees pass as parallel.
constexpr float kCosMaxAlignment = 0.985f;
constexpr uint32_t kFirstStream = 1000;
constexpr int kNumAlignmentRounds = 5;
// The least share of the core's inliers that must agree with an aligned plane.
constexpr float kMinAlignedShare = 0.8f;

// The part of a grown region that lies outside its core.
struct RimKernel {
  ImageView<const int> grown;
  ImageView<const int> core;
  ImageView<int> rim;
  TSAR_HD void operator()(int x, int y) const {
    rim(x, y) = core(x, y) < 0 ? grown(x, y) : -1;
  }
};

struct ChooseKernel {
  const GroupPlane* core_fits;
  const GroupPlane* rim_fits;
  const int* core_begin;
  const int* core_pixels;
  const int* rim_begin;
  const int* rim_pixels;
  const RayDepth* remaining;
  DisparityScale scale;
  RegionPlaneOptions options;
  int slot;
  // Per region: inliers of the first plane, negative where the rim gave it.
  int* first_inliers;
  SupportedPlane* planes;

  TSAR_HD void operator()(int64_t k) const {
    const GroupPlane& core = core_fits[k];
    const GroupPlane& rim = rim_fits[k];
    SupportedPlane result;
    if (slot == 0) {
      first_inliers[k] = 0;
    }
    const int first = first_inliers[k];
    if (first >= 0 && IsCarriedByCore(core) &&
        core.num_inliers >= options.min_further_share * first) {
      result = {AlignedWithRim(core, rim, k), core.support};
      first_inliers[k] = slot == 0 ? core.num_inliers : first;
    } else if (first <= 0 && (slot == 0 || first < 0) && IsCarriedByRim(rim) &&
               rim.num_inliers >= -options.min_further_share * first &&
               (slot > 0 ||
                MeanRimGap(rim.plane, k) < options.max_boundary_error)) {
      result = {rim.plane, rim.support};
      first_inliers[k] = slot == 0 ? -rim.num_inliers : first;
    } else {
      // Nothing more carries a plane here; later rounds shall not try.
      first_inliers[k] = INT32_MAX;
    }
    planes[k * kMaxPlanesPerRegion + slot] = result;
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

  // What hangs on a wall is parallel to it, and textured: its many good samples
  // tell the direction of the wall better than the few of the core, which tell
  // how far behind it lies. Kept where the core's samples agree.
  TSAR_HD Plane AlignedWithRim(const GroupPlane& core,
                               const GroupPlane& rim,
                               int64_t k) const {
    if (!IsCarriedByRim(rim) || rim.num_inliers < core.num_inliers ||
        Dot(core.plane.normal, rim.plane.normal) < kCosMaxAlignment) {
      return core.plane;
    }
    const Vec3f middle = {core.support.mean_x, core.support.mean_y, 1.f};
    Plane plane =
        Plane::FromPoint(middle, core.plane.Depth(middle), rim.plane.normal);
    for (int round = 0; round < kNumAlignmentRounds; ++round) {
      double sum = 0;
      double sum_weights = 0;
      for (int i = core_begin[k]; i < core_begin[k + 1]; ++i) {
        const RayDepth& sample = remaining[core_pixels[i]];
        if (!(sample.z > 0.f)) {
          continue;
        }
        const float ratio = RelativeDistance(plane, sample) /
                            options.ransac.tolerance.At(sample.z, scale);
        if (ratio < 1.f) {
          const double weight = 1.0 / (1.0 + 4.0 * ratio * ratio);
          sum += weight * -Dot(plane.normal, ToPoint(sample));
          sum_weights += weight;
        }
      }
      if (!(sum_weights > 0.0)) {
        return core.plane;
      }
      plane.offset = static_cast<float>(sum / sum_weights);
    }
    int num_inliers = 0;
    for (int i = core_begin[k]; i < core_begin[k + 1]; ++i) {
      const RayDepth& sample = remaining[core_pixels[i]];
      num_inliers +=
          sample.z > 0.f && RelativeDistance(plane, sample) <
                                options.ransac.tolerance.At(sample.z, scale)
              ? 1
              : 0;
    }
    return num_inliers >= kMinAlignedShare * core.num_inliers ? plane
                                                              : core.plane;
  }

  // The mean depth gap of Eq. 15.
  TSAR_HD float MeanRimGap(const Plane& plane, int64_t k) const {
    float sum = 0.f;
    int count = 0;
    for (int i = rim_begin[k]; i < rim_begin[k + 1]; ++i) {
      const RayDepth& sample = remaining[rim_pixels[i]];
      if (sample.z > 0.f) {
        const float depth = plane.Depth({sample.x, sample.y, 1.f});
        sum += fminf(fabsf(depth - sample.z) / sample.z,
                     2.f * options.max_boundary_error);
        ++count;
      }
    }
    return count > 0 ? sum / count : 0.f;
  }
};

// Takes the samples of the plane just found out of the search for the next.
struct RemoveInliersKernel {
  ImageView<const int> grown;
  const SupportedPlane* planes;
  int slot;
  PlaneTolerance tolerance;
  DisparityScale scale;
  ImageView<RayDepth> remaining;

  TSAR_HD void operator()(int x, int y) const {
    const int label = grown(x, y);
    RayDepth& sample = remaining(x, y);
    if (label < 0 || !(sample.z > 0.f)) {
      return;
    }
    const Plane& plane = planes[label * kMaxPlanesPerRegion + slot].plane;
    if (plane.Valid() &&
        RelativeDistance(plane, sample) < 2.f * tolerance.At(sample.z, scale)) {
      sample = {};
    }
  }
};

// The samples of one region in a block of 4 x 4 pixels, by plane.
struct BlockVotes {
  int region = -1;
  float votes[kMaxPlanesPerRegion] = {};
};

constexpr int kBlockSize = 4;
// How far votes reach, in blocks, and the distance at which they count a
// quarter.
constexpr int kVoteRadius = 32;
constexpr float kVoteScale = 4.f;

struct CountVotesKernel {
  ImageView<const int> labels;
  ImageView<const int> grown;
  ImageView<const RayDepth> samples;
  const SupportedPlane* planes;
  PlaneTolerance tolerance;
  DisparityScale scale;
  ImageView<BlockVotes> blocks;

  TSAR_HD void operator()(int column, int row) const {
    BlockVotes block;
    block.region = Region(labels, column, row);
    if (block.region < 0) {
      block.region = Region(grown, column, row);
    }
    for (int i = 0; i < kBlockSize * kBlockSize && block.region >= 0; ++i) {
      const int x = column * kBlockSize + i % kBlockSize;
      const int y = row * kBlockSize + i / kBlockSize;
      if (!grown.Contains(x, y) || grown(x, y) != block.region ||
          !(samples(x, y).z > 0.f)) {
        continue;
      }
      const float max_distance = tolerance.At(samples(x, y).z, scale);
      for (int slot = 0; slot < kMaxPlanesPerRegion; ++slot) {
        const Plane& plane =
            planes[block.region * kMaxPlanesPerRegion + slot].plane;
        if (plane.Valid() &&
            RelativeDistance(plane, samples(x, y)) < max_distance) {
          block.votes[slot] += 1.f;
        }
      }
    }
    blocks(column, row) = block;
  }

  // The first label in the block.
  TSAR_HD static int Region(const ImageView<const int>& labels,
                            int column,
                            int row) {
    for (int i = 0; i < kBlockSize * kBlockSize; ++i) {
      const int x = column * kBlockSize + i % kBlockSize;
      const int y = row * kBlockSize + i / kBlockSize;
      if (labels.Contains(x, y) && labels(x, y) >= 0) {
        return labels(x, y);
      }
    }
    return -1;
  }
};

// The plane with most votes around each block, nearer ones counting more.
struct ElectKernel {
  ImageView<const BlockVotes> blocks;
  const SupportedPlane* planes;
  ImageView<int> slots;

  TSAR_HD void operator()(int column, int row) const {
    const int region = blocks(column, row).region;
    slots(column, row) = 0;
    if (region < 0 || !planes[region * kMaxPlanesPerRegion + 1].plane.Valid()) {
      return;
    }
    float sums[kMaxPlanesPerRegion] = {};
    for (int r = row - kVoteRadius; r <= row + kVoteRadius; ++r) {
      for (int c = column - kVoteRadius; c <= column + kVoteRadius; ++c) {
        if (!blocks.Contains(c, r) || blocks(c, r).region != region) {
          continue;
        }
        const float squared = static_cast<float>((c - column) * (c - column) +
                                                 (r - row) * (r - row));
        const float weight = 1.f + squared / (kVoteScale * kVoteScale);
        for (int slot = 0; slot < kMaxPlanesPerRegion; ++slot) {
          sums[slot] += blocks(c, r).votes[slot] / (weight * weight);
        }
      }
    }
    for (int slot = 1; slot < kMaxPlanesPerRegion; ++slot) {
      if (sums[slot] > sums[slots(column, row)]) {
        slots(column, row) = slot;
      }
    }
  }
};

struct AssignKernel {
  ImageView<const int> labels;
  ImageView<const BlockVotes> blocks;
  ImageView<const int> slots;
  const SupportedPlane* planes;
  Intrinsics intrinsics;
  float max_squared_distance;
  ImageView<Plane> result;

  TSAR_HD void operator()(int x, int y) const {
    const int label = labels(x, y);
    result(x, y) = {};
    if (label < 0) {
      return;
    }
    const int slot = Slot(label, x / kBlockSize, y / kBlockSize);
    const SupportedPlane& chosen = planes[label * kMaxPlanesPerRegion + slot];
    if (chosen.plane.Valid() && chosen.support.SquaredDistance(intrinsics.Ray(
                                    x, y)) <= max_squared_distance) {
      result(x, y) = chosen.plane;
    }
  }

  // That of the pixel's block, or of a neighbouring one of the same region.
  TSAR_HD int Slot(int label, int column, int row) const {
    if (blocks(column, row).region == label) {
      return slots(column, row);
    }
    for (int r = row - 1; r <= row + 1; ++r) {
      for (int c = column - 1; c <= column + 1; ++c) {
        if (blocks.Contains(c, r) && blocks(c, r).region == label) {
          return slots(c, r);
        }
      }
    }
    return 0;
  }
};

}  // namespace

RegionPlanes FitRegionPlanes(const Regions& regions,
                             ImageView<const RayDepth> samples,
                             const DisparityScale& scale,
                             const RegionPlaneOptions& options,
                             Device& device) {
  const ImageView<const int> labels = regions.labels.View();
  const int width = labels.width;
  const int height = labels.height;
  const DeviceImage<int> grown = GrowLabels(labels, options.rim_width, device);
  DeviceImage<int> core = ShrinkLabels(labels, options.core_margin, device);
  if (!options.use_core) {
    Fill(device, core.View().data, core.View().NumPixels(), -1);
  }
  DeviceImage<int> rim(device, width, height);
  ParallelFor(
      device, width, height, RimKernel{grown.View(), core.View(), rim.View()});
  const PixelGroups core_groups =
      GroupPixels(core.View(), regions.count, device);
  const PixelGroups rim_groups = GroupPixels(rim.View(), regions.count, device);

  RegionPlanes result{Buffer<SupportedPlane>(
      device, static_cast<size_t>(regions.count) * kMaxPlanesPerRegion)};
  Buffer<int> first_inliers(device, regions.count);
  DeviceImage<RayDepth> remaining(device, width, height);
  Copy(device, samples.data, samples.NumPixels(), remaining.View().data);
  Fill(device, result.planes.Data(), result.planes.Size(), SupportedPlane{});
  for (int slot = 0; slot < options.max_planes; ++slot) {
    GroupPlaneOptions ransac = options.ransac;
    // Superpixels draw from the streams below kFirstStream.
    ransac.iteration = kFirstStream + 2 * slot;
    const Buffer<GroupPlane> core_fits =
        FitGroupPlanes(core_groups, remaining.View(), scale, ransac, device);
    ++ransac.iteration;
    const Buffer<GroupPlane> rim_fits =
        FitGroupPlanes(rim_groups, remaining.View(), scale, ransac, device);
    ParallelFor(device,
                regions.count,
                ChooseKernel{core_fits.Data(),
                             rim_fits.Data(),
                             core_groups.begin.Data(),
                             core_groups.pixels.Data(),
                             rim_groups.begin.Data(),
                             rim_groups.pixels.Data(),
                             remaining.View().data,
                             scale,
                             options,
                             slot,
                             first_inliers.Data(),
                             result.planes.Data()});
    ParallelFor(device,
                width,
                height,
                RemoveInliersKernel{grown.View(),
                                    result.planes.Data(),
                                    slot,
                                    ransac.tolerance,
                                    scale,
                                    remaining.View()});
  }
  return result;
}

DeviceImage<Plane> AssignRegionPlanes(const Regions& regions,
                                      const RegionPlanes& planes,
                                      ImageView<const RayDepth> samples,
                                      const Intrinsics& intrinsics,
                                      const DisparityScale& scale,
                                      const RegionPlaneOptions& options,
                                      Device& device) {
  const ImageView<const int> labels = regions.labels.View();
  const DeviceImage<int> grown = GrowLabels(labels, options.rim_width, device);
  const int columns = (labels.width + kBlockSize - 1) / kBlockSize;
  const int rows = (labels.height + kBlockSize - 1) / kBlockSize;
  DeviceImage<BlockVotes> blocks(device, columns, rows);
  ParallelFor(device,
              columns,
              rows,
              CountVotesKernel{labels,
                               grown.View(),
                               samples,
                               planes.planes.Data(),
                               options.ransac.tolerance,
                               scale,
                               blocks.View()});
  DeviceImage<int> slots(device, columns, rows);
  ParallelFor(device,
              columns,
              rows,
              ElectKernel{blocks.View(), planes.planes.Data(), slots.View()});
  DeviceImage<Plane> result(device, labels.width, labels.height);
  ParallelFor(
      device,
      labels.width,
      labels.height,
      AssignKernel{labels,
                   blocks.View(),
                   slots.View(),
                   planes.planes.Data(),
                   intrinsics,
                   options.max_extrapolation * options.max_extrapolation,
                   result.View()});
  return result;
}

}  // namespace tsar
