// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/evidence/render_source_depth.h"

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/device/atomic.h"
#include "colmap_tsar/device/parallel_for.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace tsar {
namespace {

// A surface in front needs this many of the 5x5 pixels around, within this
// relative difference of its nearest point there.
constexpr int kFrontRadius = 2;
constexpr int kMinFrontPixels = 8;  // Out of 25.
constexpr float kOneFront = 0.03f;

// The inverse of BitsOf(); positive floats are ordered as their bits are.
TSAR_HD inline float FromBits(int bits) {
  float value = 0.f;
  memcpy(&value, &bits, sizeof(value));
  return value;
}

struct PlaneDepthKernel {
  ImageView<const uint16_t> superpixels;
  const Plane* planes;
  Intrinsics intrinsics;
  ImageView<float> surface;

  TSAR_HD void operator()(int x, int y) const {
    const Plane& plane = planes[superpixels(x, y)];
    const float depth = plane.Valid() ? plane.Depth(intrinsics.Ray(x, y)) : 0.f;
    surface(x, y) = depth > 0.f ? depth : 0.f;
  }
};

struct MeasuredKernel {
  ImageView<const float> measured;
  ImageView<float> surface;

  TSAR_HD void operator()(int64_t i) const {
    if (measured.data[i] > 0.f) {
      surface.data[i] = measured.data[i];
    }
  }
};

// Renders the surface of a source into the reference's raster: the nearest
// depth at each pixel.
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
    const Vec3f point = to_reference * (source.Ray(x, y) * depth);
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
    // Bits of positive numbers are in the order of these.
    int nearest_of_all = BitsOf(INFINITY);
    int nearest_of_nine = nearest_of_all;
    for (int j = -kFrontRadius; j <= kFrontRadius; ++j) {
      for (int i = -kFrontRadius; i <= kFrontRadius; ++i) {
        if (!nearest.Contains(x + i, y + j)) {
          continue;
        }
        const int depth = nearest(x + i, y + j);
        nearest_of_all = depth < nearest_of_all ? depth : nearest_of_all;
        if (i >= -1 && i <= 1 && j >= -1 && j <= 1) {
          nearest_of_nine = depth < nearest_of_nine ? depth : nearest_of_nine;
        }
      }
    }
    const float limit = (1.f + kOneFront) * FromBits(nearest_of_all);
    int count = 0;
    for (int j = -kFrontRadius; j <= kFrontRadius; ++j) {
      for (int i = -kFrontRadius; i <= kFrontRadius; ++i) {
        count += nearest.Contains(x + i, y + j) &&
                         FromBits(nearest(x + i, y + j)) < limit
                     ? 1
                     : 0;
      }
    }
    front(x, y) =
        count >= kMinFrontPixels ? FromBits(nearest_of_nine) : INFINITY;
  }
};

}  // namespace

DeviceImage<float> DepthOfPlanes(const ObservedView& view,
                                 const std::vector<Plane>& planes,
                                 Device& device) {
  const ViewEvidence& evidence = *view.evidence;
  const DeviceImage<uint16_t> superpixels(device, evidence.superpixels);
  const Buffer<Plane> device_planes(device, planes);
  DeviceImage<float> depth(device, evidence.width, evidence.height);
  ParallelFor(device,
              depth.Width(),
              depth.Height(),
              PlaneDepthKernel{superpixels.View(),
                               device_planes.Data(),
                               view.camera.GetIntrinsics(),
                               depth.View()});
  return depth;
}

DeviceImage<float> SeenDepth(const ObservedView& view,
                             const std::vector<Plane>& planes,
                             Device& device) {
  DeviceImage<float> depth = DepthOfPlanes(view, planes, device);
  const DeviceImage<float> measured(device, view.evidence->confident_depth);
  ParallelFor(device,
              depth.View().NumPixels(),
              MeasuredKernel{measured.View(), depth.View()});
  return depth;
}

DeviceImage<float> RenderSourceDepth(const ObservedView& reference,
                                     const ObservedView& source,
                                     ImageView<const float> depth,
                                     Device& device) {
  DeviceImage<int> nearest(
      device, reference.evidence->width, reference.evidence->height);
  Fill(device,
       nearest.View().data,
       nearest.View().NumPixels(),
       BitsOf(std::numeric_limits<float>::infinity()));
  ParallelFor(device,
              depth.width,
              depth.height,
              DrawKernel{depth,
                         source.camera.GetIntrinsics(),
                         ComputeRelativePose(source.camera, reference.camera),
                         reference.camera.GetIntrinsics(),
                         nearest.View()});
  DeviceImage<float> front(device, nearest.Width(), nearest.Height());
  ParallelFor(device,
              front.Width(),
              front.Height(),
              FrontKernel{nearest.View(), front.View()});
  return front;
}

}  // namespace tsar
