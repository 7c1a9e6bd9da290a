// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/view/regions/region_planes.h"

namespace tsar {
namespace {

// The samples of one region in a block of 4 x 4 pixels, by plane.
struct BlockVotes {
  int region = -1;
  float votes[kMaxPlanesPerRegion] = {};
};

constexpr int kBlockSize = 4;
// The radius of votes, in blocks, and the distance at which their weight is a
// quarter.
constexpr int kVoteRadius = 32;
constexpr float kVoteScale = 4.f;

struct CountVotesKernel {
  ImageView<const int> labels;
  ImageView<const int> grown;
  ImageView<const RayDepth> samples;
  const SupportedPlane* planes;
  PlaneTolerance tolerance;
  DepthResolution resolution;

  TSAR_HD BlockVotes operator()(int column, int row) const {
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
      const float max_distance = tolerance.At(samples(x, y).z, resolution);
      for (int slot = 0; slot < kMaxPlanesPerRegion; ++slot) {
        const Plane& plane =
            planes[block.region * kMaxPlanesPerRegion + slot].plane;
        if (plane.Valid() &&
            RelativeDistance(plane, samples(x, y)) < max_distance) {
          block.votes[slot] += 1.f;
        }
      }
    }
    return block;
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

  TSAR_HD int operator()(int column, int row) const {
    const int region = blocks(column, row).region;
    if (region < 0 || !planes[region * kMaxPlanesPerRegion + 1].plane.Valid()) {
      return 0;
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
    int best = 0;
    for (int slot = 1; slot < kMaxPlanesPerRegion; ++slot) {
      best = sums[slot] > sums[best] ? slot : best;
    }
    return best;
  }
};

struct AssignKernel {
  ImageView<const int> labels;
  ImageView<const BlockVotes> blocks;
  ImageView<const int> slots;
  const SupportedPlane* planes;
  Intrinsics intrinsics;
  float max_squared_distance;

  TSAR_HD Plane operator()(int x, int y) const {
    const int label = labels(x, y);
    if (label < 0) {
      return {};
    }
    const int slot = Slot(label, x / kBlockSize, y / kBlockSize);
    const SupportedPlane& chosen = planes[label * kMaxPlanesPerRegion + slot];
    const bool is_supported = chosen.support.SquaredDistance(
                                  intrinsics.Ray(x, y)) <= max_squared_distance;
    return chosen.plane.Valid() && is_supported ? chosen.plane : Plane{};
  }

  // The plane elected in the pixel's block, or in a neighboring block of the
  // same region.
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

DeviceImage<Plane> AssignRegionPlanes(const Regions& regions,
                                      const RegionPlanes& planes,
                                      ImageView<const RayDepth> samples,
                                      const Intrinsics& intrinsics,
                                      const DepthResolution& resolution,
                                      const RegionPlaneOptions& options,
                                      Device& device) {
  const ImageView<const int> labels = regions.labels.View();
  const int columns = (labels.width + kBlockSize - 1) / kBlockSize;
  const int rows = (labels.height + kBlockSize - 1) / kBlockSize;
  const DeviceImage<BlockVotes> blocks =
      MapPixels<BlockVotes>(device,
                            columns,
                            rows,
                            CountVotesKernel{labels,
                                             planes.grown.View(),
                                             samples,
                                             planes.planes.Data(),
                                             options.ransac.tolerance,
                                             resolution});
  const DeviceImage<int> slots = MapPixels<int>(
      device, columns, rows, ElectKernel{blocks.View(), planes.planes.Data()});
  return MapPixels<Plane>(
      device,
      labels.width,
      labels.height,
      AssignKernel{labels,
                   blocks.View(),
                   slots.View(),
                   planes.planes.Data(),
                   intrinsics,
                   options.max_extrapolation * options.max_extrapolation});
}

}  // namespace tsar
