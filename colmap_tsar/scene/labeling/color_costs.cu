// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/labeling/color_costs.h"

#include "colmap_tsar/base/camera.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/scan_and_sort.h"
#include "colmap_tsar/scene/evidence/observed_source.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/scene/labeling/color_regions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace tsar {
namespace {

// The difference that counts in full, in gray levels over the three channels.
constexpr float kFullDifference = 20.f;
// A source is used for a region if it sees this share of it, and a plane needs
// at least this many sources. More than kMaxSources change little.
constexpr float kMinShareSeen = 0.4f;
constexpr int kMinSources = 3;
constexpr int kMaxSources = 12;
// A point is occluded where the source's depth is smaller by this share.
constexpr float kHidden = 0.03f;
constexpr VoteSampling kRegionSampling{9, 400};
// Pairs of a source and a plane for all regions of a batch, 1 MB of results.
constexpr int kMinBatch = 1 << 18;

// The color difference of a region of the reference and one source, on a plane.
struct SourceColorKernel {
  PixelGroupsView regions;
  const Plane* planes;
  int num_planes;
  const ObservedSource* sources;
  VoteSampling sampling;
  ImageView<const Rgb> color;  // Reference image.
  Intrinsics intrinsics;
  // Column: source * num_planes + plane, row: region.
  ImageView<float> differences;

  TSAR_HD void operator()(int column, int region) const {
    differences(column, region) = InSource(
        sources[column / num_planes], planes[column % num_planes], region);
  }

  // The mean over the region's pixels, from 0 to 1; negative where too few of
  // them are visible.
  TSAR_HD float InSource(const ObservedSource& source,
                         const Plane& plane,
                         int region) const {
    const int num_pixels = regions.Count(region);
    if (num_pixels == 0) {
      return -1.f;
    }
    const int num_tests = sampling.NumTests(num_pixels);
    float sum = 0.f;
    int num_seen = 0;
    for (int i = 0; i < num_tests; ++i) {
      const int pixel =
          regions.Pixel(region, VoteSampling::Pixel(i, num_tests, num_pixels));
      const auto x = static_cast<float>(pixel % color.width);
      const auto y = static_cast<float>(pixel / color.width);
      const Vec3f ray = intrinsics.Ray(x, y);
      const float depth = plane.Depth(ray);
      SeenPoint seen;
      if (!(depth > 0.f) || !FindInSource(source, ray * depth, &seen)) {
        continue;
      }
      const float measured = source.confident_depth(seen.column, seen.row);
      if (measured > 0.f && measured < (1.f - kHidden) * seen.depth) {
        continue;
      }
      const Vec3f gain = source.gain.At(
          SquaredRadius(x, y, color.width, color.height),
          SquaredRadius(seen.x, seen.y, source.width, source.height));
      const Rgb there = source.color(seen.column, seen.row);
      const Rgb own = color.data[pixel];
      const Vec3f difference{gain.x * there.r - own.r,
                             gain.y * there.g - own.g,
                             gain.z * there.b - own.b};
      sum += fminf(
          Dot(difference, difference) / (kFullDifference * kFullDifference),
          1.f);
      ++num_seen;
    }
    return num_seen > 0 && num_seen >= kMinShareSeen * num_tests
               ? sum / num_seen
               : -1.f;
  }
};

// The mean of the better half of the sources that see a region, since
// occlusions in others are not always known.
struct RegionColorKernel {
  ImageView<const float> of_sources;
  int num_sources;
  // Column: plane, row: region; negative where too few sources see it.
  ImageView<float> differences;

  TSAR_HD void operator()(int k, int r) const {
    float best[kMaxSources];
    int count = 0;
    for (int j = 0; j < num_sources && count < kMaxSources; ++j) {
      const float difference = of_sources(j * differences.width + k, r);
      if (difference < 0.f) {
        continue;
      }
      int rank = count++;
      for (; rank > 0 && best[rank - 1] > difference; --rank) {
        best[rank] = best[rank - 1];
      }
      best[rank] = difference;
    }
    const int half = (count + 1) / 2;
    float sum = 0.f;
    for (int i = 0; i < half; ++i) {
      sum += best[i];
    }
    differences(k, r) = count < kMinSources ? -1.f : sum / half;
  }
};

// The color difference of a superpixel's region on each plane beyond that on
// the best plane that is known there, and beyond noise and gloss; the largest
// value of all levels of regions.
struct GapKernel {
  const int* region_of_superpixel;
  ImageView<const float> differences;
  ImageView<const PlaneCost> costs;
  LabelOptions options;
  ImageView<float> gaps;

  TSAR_HD void operator()(int64_t s) const {
    const auto row = static_cast<int>(s);
    const int region = region_of_superpixel[s];
    float best = INFINITY;
    for (int k = 0; k < gaps.width; ++k) {
      const float difference = differences(k, region);
      if (difference >= 0.f &&
          costs(k, row).uncertainty < options.max_color_uncertainty) {
        best = fminf(best, difference);
      }
    }
    for (int k = 0; k < gaps.width; ++k) {
      gaps(k, row) = fmaxf(
          gaps(k, row), differences(k, region) - best - options.min_color_gap);
    }
  }
};

struct AddGapsKernel {
  ImageView<const float> gaps;
  const float* unobserved;  // Pixels of each superpixel.
  float color_cost;
  ImageView<PlaneCost> costs;

  TSAR_HD void operator()(int k, int s) const {
    costs(k, s).cost += color_cost * unobserved[s] * gaps(k, s);
  }
};

std::vector<float> CountUnobserved(const ViewEvidence& evidence) {
  std::vector<float> counts = CountPixels(evidence);
  for (size_t s = 0; s < counts.size(); ++s) {
    counts[s] = std::max(counts[s] - evidence.weights[s], 0.f);
  }
  return counts;
}

// Color differences; column: plane, row: region.
DeviceImage<float> CompareRegions(const PixelGroups& regions,
                                  const Buffer<Plane>& planes,
                                  const LabelInputs& inputs,
                                  const DeviceImage<Rgb>& color,
                                  Device& device) {
  const int num_planes = static_cast<int>(planes.Size());
  const int num_sources = std::max(inputs.NumSources(), 1);
  const int num_regions = regions.NumGroups();
  DeviceImage<float> differences(device, num_planes, num_regions);
  // Batches of regions, so that their differences in all sources take a quarter
  // of the memory of the result, or are just enough to occupy a GPU.
  const int max_rows =
      std::min(num_regions,
               std::max({num_regions / (4 * num_sources),
                         kMinBatch / (num_sources * num_planes),
                         1}));
  DeviceImage<float> of_sources(device, num_sources * num_planes, max_rows);
  const PixelGroupsView all = regions.View();
  for (int first = 0; first < num_regions; first += max_rows) {
    const int rows = std::min(max_rows, num_regions - first);
    ParallelFor(device,
                inputs.NumSources() * num_planes,
                rows,
                SourceColorKernel{{all.begin + first, all.pixels},
                                  planes.Data(),
                                  num_planes,
                                  inputs.Sources(),
                                  kRegionSampling,
                                  color.View(),
                                  inputs.Views()[0].camera.GetIntrinsics(),
                                  of_sources.View()});
    ImageView<float> part = differences.View();
    part.data += part.Index(0, first);
    part.height = rows;
    ParallelFor(
        device,
        num_planes,
        rows,
        RegionColorKernel{of_sources.View(), inputs.NumSources(), part});
  }
  return differences;
}

}  // namespace

void AddColorCosts(const LabelInputs& inputs,
                   const std::vector<Plane>& planes,
                   const LabelOptions& options,
                   ImageView<PlaneCost> costs,
                   Device& device) {
  const ObservedView& reference = inputs.Views()[0];
  const ViewEvidence& evidence = *reference.evidence;
  const Buffer<Plane> device_planes(device, planes);
  const DeviceImage<Rgb> color(device, evidence.color);
  DeviceImage<float> gaps(device, costs.width, costs.height);
  Fill(device, gaps.View().data, gaps.View().NumPixels(), 0.f);
  for (const ColorRegions& regions : FindColorRegions(reference)) {
    const PixelGroups pixels =
        GroupByLabel(evidence, regions.of_superpixel, regions.count, device);
    const DeviceImage<float> differences =
        CompareRegions(pixels, device_planes, inputs, color, device);
    const Buffer<int> region_of_superpixel(device, regions.of_superpixel);
    ParallelFor(device,
                costs.height,
                GapKernel{region_of_superpixel.Data(),
                          differences.View(),
                          costs,
                          options,
                          gaps.View()});
  }
  const Buffer<float> unobserved(device, CountUnobserved(evidence));
  ParallelFor(
      device,
      costs.width,
      costs.height,
      AddGapsKernel{gaps.View(), unobserved.Data(), options.color_cost, costs});
}

}  // namespace tsar
