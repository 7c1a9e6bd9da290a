// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/view_votes.h"

#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/fill.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/scene_planes/observed_source.h"
#include "colmap_tsar/superpixels/samples.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>

namespace tsar {
namespace {

// Relative differences of two depths that are one surface, and that are two.
constexpr float kSameSurface = 0.015f;
constexpr float kOtherSurface = 0.04f;

// A surface in front is one that fills this share of the 5x5 pixels around, as
// far as it lies within a relative difference of its nearest point there.
constexpr int kFrontRadius = 2;
constexpr int kMinFrontPixels = 8;  // Of 25.
constexpr float kOneFront = 0.03f;

// Positive floats are ordered as their bits are.
TSAR_HD inline int BitsOf(float value) {
  int bits = 0;
  memcpy(&bits, &value, sizeof(bits));
  return bits;
}
TSAR_HD inline float FromBits(int bits) {
  float value = 0.f;
  memcpy(&value, &bits, sizeof(value));
  return value;
}

// What a source sees: what it measured, else the plane of the superpixel.
struct SourceSurfaceKernel {
  ImageView<const float> confident_depth;
  ImageView<const uint16_t> superpixels;
  const Plane* planes;
  Intrinsics intrinsics;
  ImageView<float> surface;

  TSAR_HD void operator()(int x, int y) const {
    float depth = confident_depth(x, y);
    if (!(depth > 0.f)) {
      const Plane& plane = planes[superpixels(x, y)];
      depth = plane.Valid() ? plane.Depth(intrinsics.Ray(static_cast<float>(x),
                                                         static_cast<float>(y)))
                            : 0.f;
    }
    surface(x, y) = depth > 0.f ? depth : 0.f;
  }
};

// Draws the surface of a source into the reference's raster: the nearest depth
// of each pixel.
struct DrawKernel {
  ImageView<const float> surface;
  Intrinsics source;
  RelativePose to_reference;
  Intrinsics reference;
  ImageView<int> nearest;

  TSAR_HD void operator()(int x, int y) const {
    const float depth = surface(x, y);
    if (!(depth > 0.f)) {
      return;
    }
    const Vec3f point =
        to_reference *
        (source.Ray(static_cast<float>(x), static_cast<float>(y)) * depth);
    if (!(point.z > 0.f)) {
      return;
    }
    float u = 0.f;
    float v = 0.f;
    reference.Project(point, &u, &v);
    if (u > -0.5f && v > -0.5f && u < nearest.width - 0.5f &&
        v < nearest.height - 0.5f) {
      AtomicMin(
          &nearest(static_cast<int>(u + 0.5f), static_cast<int>(v + 0.5f)),
          BitsOf(point.z));
    }
  }
};

// The depth of the surface that a source shows at a pixel of the reference, by
// the nearest of the 3x3 pixels around; infinite where it shows none.
struct FrontKernel {
  ImageView<const int> nearest;
  ImageView<float> front;

  TSAR_HD void operator()(int x, int y) const {
    float nearest_of_all = INFINITY;
    float nearest_of_nine = INFINITY;
    for (int j = -kFrontRadius; j <= kFrontRadius; ++j) {
      for (int i = -kFrontRadius; i <= kFrontRadius; ++i) {
        if (!nearest.Contains(x + i, y + j)) {
          continue;
        }
        const float depth = FromBits(nearest(x + i, y + j));
        nearest_of_all = fminf(nearest_of_all, depth);
        if (i >= -1 && i <= 1 && j >= -1 && j <= 1) {
          nearest_of_nine = fminf(nearest_of_nine, depth);
        }
      }
    }
    int count = 0;
    for (int j = -kFrontRadius; j <= kFrontRadius; ++j) {
      for (int i = -kFrontRadius; i <= kFrontRadius; ++i) {
        count += nearest.Contains(x + i, y + j) &&
                         FromBits(nearest(x + i, y + j)) <
                             (1.f + kOneFront) * nearest_of_all
                     ? 1
                     : 0;
      }
    }
    front(x, y) = count >= kMinFrontPixels ? nearest_of_nine : INFINITY;
  }
};

// More views than a byte counts change nothing.
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
    if (front(ReducedRaster::FromMap(x, depth.width, front.width),
              ReducedRaster::FromMap(y, depth.height, front.height)) <
        (1.f - kOtherSurface) * own) {
      Count(&of_pixel.in_front);
    }
    SeenPoint seen;
    if (!FindInSource(
            source,
            intrinsics.Ray(static_cast<float>(x), static_cast<float>(y)) * own,
            &seen)) {
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
  const ObservedView& reference = views[0];
  std::vector<DeviceImage<ViewVotes>> votes;
  for (const ImageView<const float>& map : depths) {
    votes.emplace_back(device, map.width, map.height);
    Fill(device, votes.back().View().data, map.NumPixels(), ViewVotes{});
  }
  DeviceImage<int> nearest(
      device, reference.evidence->width, reference.evidence->height);
  DeviceImage<float> front(device, nearest.Width(), nearest.Height());
  for (size_t j = 1; j < views.size(); ++j) {
    const ViewEvidence& evidence = *views[j].evidence;
    const ObservedSource source = MakeObservedSource(reference, views[j]);
    const DeviceImage<float> confident(device, evidence.confident_depth);
    const DeviceImage<uint16_t> superpixels(device, evidence.superpixels);
    const Buffer<Plane> planes(device, surfaces.planes_of_sources[j - 1]);
    DeviceImage<float> surface(device, evidence.width, evidence.height);
    ParallelFor(device,
                surface.Width(),
                surface.Height(),
                SourceSurfaceKernel{confident.View(),
                                    superpixels.View(),
                                    planes.Data(),
                                    source.intrinsics,
                                    surface.View()});
    Fill(device,
         nearest.View().data,
         nearest.View().NumPixels(),
         BitsOf(std::numeric_limits<float>::infinity()));
    ParallelFor(
        device,
        surface.Width(),
        surface.Height(),
        DrawKernel{std::as_const(surface).View(),
                   source.intrinsics,
                   ComputeRelativePose(views[j].camera, reference.camera),
                   reference.camera.GetIntrinsics(),
                   nearest.View()});
    ParallelFor(device,
                front.Width(),
                front.Height(),
                FrontKernel{std::as_const(nearest).View(), front.View()});
    for (size_t map = 0; map < depths.size(); ++map) {
      ParallelFor(device,
                  depths[map].width,
                  depths[map].height,
                  VoteKernel{depths[map],
                             intrinsics,
                             std::as_const(front).View(),
                             source,
                             std::as_const(surface).View(),
                             votes[map].View()});
    }
  }
  return votes;
}

}  // namespace tsar
