// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/view_votes.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene/evidence/observed_source.h"
#include "colmap_tsar/scene/evidence/source_surface.h"
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

struct VoteKernel {
  ImageView<const float> depth;
  Intrinsics intrinsics;
  ImageView<const float> front;
  ObservedSource source;
  ImageView<const float> surface;
  ImageView<ViewVotes> votes;

  TSAR_HD void operator()(int x, int y) const {
    const float own = depth(x, y);
    if (!(own > 0.f)) {
      return;
    }
    ViewVotes& of_pixel = votes(x, y);
    if (ValueOnMap(front, x, y, depth.width, depth.height) <
        (1.f - kOtherSurface) * own) {
      Count(&of_pixel.in_front);
    }
    SeenPoint seen;
    if (!FindInSource(source, intrinsics.Ray(x, y) * own, &seen)) {
      return;
    }
    const float there = surface(seen.column, seen.row);
    if (there > (1.f + kOtherSurface) * seen.depth) {
      Count(&of_pixel.behind);
    } else if (there > 0.f &&
               fabsf(there - seen.depth) < kSameSurface * seen.depth) {
      Count(&of_pixel.agreeing);
    }
  }
};

}  // namespace

std::vector<DeviceImage<ViewVotes>> CountViewVotes(
    const ViewSurfaces& surfaces,
    const Intrinsics& intrinsics,
    const std::vector<ImageView<const float>>& depths,
    Device& device) {
  const std::vector<ObservedView>& views = surfaces.views;
  std::vector<DeviceImage<ViewVotes>> votes;
  for (const ImageView<const float>& map : depths) {
    votes.emplace_back(device, map.width, map.height);
    Fill(device, votes.back().View().data, map.NumPixels(), ViewVotes{});
  }
  for (size_t j = 1; j < views.size(); ++j) {
    const DeviceImage<float> seen =
        SeenDepth(views[j], surfaces.planes_of_sources[j - 1], device);
    const DeviceImage<float> front =
        DrawIntoReference(views[0], views[j], seen.View(), device);
    const ObservedSource source = MakeObservedSource(views[0], views[j]);
    for (size_t map = 0; map < depths.size(); ++map) {
      ParallelFor(device,
                  depths[map].width,
                  depths[map].height,
                  VoteKernel{depths[map],
                             intrinsics,
                             front.View(),
                             source,
                             seen.View(),
                             votes[map].View()});
    }
  }
  return votes;
}

}  // namespace tsar
