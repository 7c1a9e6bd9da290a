// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/occlusion_votes.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene/evidence/observed_source.h"
#include "colmap_tsar/scene/evidence/render_source_depth.h"
#include "colmap_tsar/view/superpixels/samples.h"

#include <cmath>
#include <cstdint>

namespace tsar {
namespace {

// The largest relative difference of depths of one surface.
constexpr float kSameSurface = 0.015f;

// Increments a count that saturates at the maximum of a byte.
TSAR_HD inline void Count(uint8_t* votes) {
  *votes = static_cast<uint8_t>(*votes < UINT8_MAX ? *votes + 1 : UINT8_MAX);
}

// The color difference that counts in full, in gray levels over the three
// channels.
constexpr int kFullDifference = 20;

struct VoteKernel {
  ImageView<const float> depth;
  Intrinsics intrinsics;
  ImageView<const Rgb> color;  // Of the reference, on its raster.
  ImageView<const float> front;
  ObservedSource source;
  ImageView<const float> surface;
  ImageView<OcclusionVotes> votes;

  TSAR_HD void operator()(int x, int y) const {
    const float own = depth(x, y);
    if (!(own > 0.f)) {
      return;
    }
    OcclusionVotes& of_pixel = votes(x, y);
    if (ValueOnMap(front, x, y, depth.width, depth.height) <
        (1.f - kOtherSurface) * own) {
      Count(&of_pixel.in_front);
    }
    SeenPoint seen;
    if (!FindInSource(source, intrinsics.Ray(x, y) * own, &seen)) {
      return;
    }
    const float there = surface(seen.column, seen.row);
    if (!(there > 0.f && there < (1.f - kOtherSurface) * seen.depth)) {
      AddColor(
          ValueOnMap(color, x, y, depth.width, depth.height), seen, &of_pixel);
    }
    if (there > (1.f + kOtherSurface) * seen.depth) {
      Count(&of_pixel.behind);
    } else if (there > 0.f &&
               fabsf(there - seen.depth) < kSameSurface * seen.depth) {
      Count(&of_pixel.agreeing);
    }
  }

  // The least difference to the 3x3 pixels around the point: depths of one
  // surface are off by up to a pixel.
  TSAR_HD void AddColor(const Rgb& own,
                        const SeenPoint& seen,
                        OcclusionVotes* of_pixel) const {
    constexpr int kFull = kFullDifference * kFullDifference;
    int least = kFull;
    for (int v = seen.row - 1; v <= seen.row + 1; ++v) {
      for (int u = seen.column - 1; u <= seen.column + 1; ++u) {
        if (source.color.Contains(u, v)) {
          const Rgb& there = source.color(u, v);
          const int r = there.r - own.r;
          const int g = there.g - own.g;
          const int b = there.b - own.b;
          const int squared = r * r + g * g + b * b;
          least = squared < least ? squared : least;
        }
      }
    }
    const auto difference = static_cast<uint8_t>(
        (OcclusionVotes::kNoColor - 1) * (static_cast<float>(least) / kFull));
    if (difference < of_pixel->color) {
      of_pixel->second_color = of_pixel->color;
      of_pixel->color = difference;
    } else if (difference < of_pixel->second_color) {
      of_pixel->second_color = difference;
    }
  }
};

}  // namespace

std::vector<DeviceImage<OcclusionVotes>> CountOcclusionVotes(
    const ViewSurfaces& surfaces,
    const Intrinsics& intrinsics,
    const std::vector<ImageView<const float>>& depths,
    Device& device) {
  const std::vector<ObservedView>& views = surfaces.views;
  std::vector<DeviceImage<OcclusionVotes>> votes;
  for (const ImageView<const float>& map : depths) {
    votes.emplace_back(device, map.width, map.height);
    Fill(device, votes.back().View().data, map.NumPixels(), OcclusionVotes{});
  }
  const DeviceImage<Rgb> color(device, views[0].evidence->color);
  for (size_t j = 1; j < views.size(); ++j) {
    const DeviceImage<float> seen =
        SeenDepth(views[j], surfaces.planes_of_sources[j - 1], device);
    const DeviceImage<float> front =
        RenderSourceDepth(views[0], views[j], seen.View(), device);
    const DeviceImage<Rgb> source_color(device, views[j].evidence->color);
    ObservedSource source = MakeObservedSource(views[0], views[j]);
    source.color = source_color.View();
    for (size_t map = 0; map < depths.size(); ++map) {
      ParallelFor(device,
                  depths[map].width,
                  depths[map].height,
                  VoteKernel{depths[map],
                             intrinsics,
                             color.View(),
                             front.View(),
                             source,
                             seen.View(),
                             votes[map].View()});
    }
  }
  return votes;
}

}  // namespace tsar
