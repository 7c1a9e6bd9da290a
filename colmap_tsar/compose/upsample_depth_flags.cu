// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/upsample_depth_flags.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/device/parallel_for_pixels.h"
#include "colmap_tsar/scene/evidence/measurement_flags.h"
#include "colmap_tsar/view/block_depth.h"
#include "colmap_tsar/view/filter/confirmation.h"
#include "colmap_tsar/view/reduce_view.h"

#include <climits>
#include <cmath>
#include <string>

namespace tsar {
namespace {

constexpr float kToleranceInErrors = 0.5f;
constexpr float kMinTolerance = 3e-3f;

struct UpsampleDepthFlagsKernel {
  // Of a reduced view (ReduceView): its MeasurementFlags and hypotheses.
  ImageView<const uint8_t> judged;
  DepthNormalViews hypotheses;
  Intrinsics reduced;
  int factor;
  // Of the map.
  ImageView<const float> depth;
  Intrinsics intrinsics;
  DepthResolution resolution;

  // Whether a depth of the map lies on the plane of a reduced pixel's
  // hypothesis.
  TSAR_HD bool IsOnPlane(
      int column, int row, const Vec3f& ray, float own, float tolerance) const {
    const float judged_depth = hypotheses.depth(column, row);
    if (!(judged_depth > 0.f)) {
      return false;
    }
    const Plane plane = Plane::FromPoint(
        reduced.Ray(column, row), judged_depth, hypotheses.normal(column, row));
    // A normal that faces away does not determine the slant.
    const float on_ray = plane.Valid() ? plane.Depth(ray) : judged_depth;
    return fabsf(on_ray - own) <= tolerance * own;
  }

  TSAR_HD uint8_t operator()(int x, int y) const {
    const float own = depth(x, y);
    uint8_t flags = 0;
    if (own > 0.f) {
      const float tolerance =
          fmaxf(kToleranceInErrors * resolution.RelativeDepthError(own),
                kMinTolerance);
      const Vec3f ray = intrinsics.Ray(x, y);
      int nearest = INT_MAX;
      for (int row = y / factor - 1; row <= y / factor + 1; ++row) {
        for (int column = x / factor - 1; column <= x / factor + 1; ++column) {
          if (!judged.Contains(column, row)) {
            continue;
          }
          // The offset from the center of the block, in half pixels; the
          // block that covers the pixel is the nearest.
          const int to_x = 2 * (x - column * factor) - (factor - 1);
          const int to_y = 2 * (y - row * factor) - (factor - 1);
          const int distance = to_x * to_x + to_y * to_y;
          if (distance < nearest &&
              IsOnPlane(column, row, ray, own, tolerance)) {
            nearest = distance;
            flags = judged(column, row);
          }
        }
      }
    }
    return flags;
  }
};

struct PackFlagsKernel {
  ImageView<const uint8_t> trusted;
  ImageView<const uint8_t> confirmations;

  TSAR_HD uint8_t operator()(int x, int y) const {
    return MeasurementFlags::Pack(
        trusted(x, y) != 0,
        confirmations.Empty() ? Confirmation::kNone
                              : static_cast<Confirmation>(confirmations(x, y)));
  }
};

struct ReduceKernel {
  BlockDepth blocks;
  Intrinsics reduced;
  ImageView<float> depth;
  ImageView<Vec3f> normal;

  TSAR_HD void operator()(int x, int y) const {
    depth(x, y) = 0.f;
    normal(x, y) = {};
    const ptrdiff_t found = blocks.Find(x, y);
    if (found >= 0) {
      depth(x, y) = blocks.DepthOnRay(found, reduced.Ray(x, y));
      normal(x, y) = blocks.normal.data[found];
    }
  }
};

}  // namespace

DeviceImage<uint8_t> UpsampleDepthFlags(const ViewEvidence& evidence,
                                        const DeviceReference& view,
                                        Device& device) {
  const int factor = FactorBetween(view.Width(),
                                   view.Height(),
                                   evidence.flags.Width(),
                                   evidence.flags.Height());
  if (factor == 0) {
    throw Error(ErrorCode::kMismatch,
                "its evidence rates " + std::to_string(evidence.flags.Width()) +
                    "x" + std::to_string(evidence.flags.Height()) +
                    " pixels, which its depth map of " +
                    std::to_string(view.Width()) + "x" +
                    std::to_string(view.Height()) +
                    " does not have at any scale; delete the folder "
                    "stereo/tsar/evidence and run again");
  }
  DeviceImage<uint8_t> flags(device, evidence.flags);
  if (factor == 1) {
    return flags;
  }
  const DepthNormalImages reduced = ReduceHypotheses(view, factor, device);
  return MapPixels<uint8_t>(
      device,
      view.Width(),
      view.Height(),
      UpsampleDepthFlagsKernel{
          flags.View(),
          reduced.Views(),
          ReduceCamera(view.camera, factor).GetIntrinsics(),
          factor,
          view.hypotheses.depth.View(),
          view.MapIntrinsics(),
          evidence.resolution});
}

DeviceImage<uint8_t> PackFlags(ImageView<const uint8_t> trusted,
                               ImageView<const uint8_t> confirmations,
                               Device& device) {
  return MapPixels<uint8_t>(device,
                            trusted.width,
                            trusted.height,
                            PackFlagsKernel{trusted, confirmations});
}

DepthNormalImages ReduceHypotheses(const DeviceReference& view,
                                   int factor,
                                   Device& device) {
  const Camera camera = ReduceCamera(view.camera, factor);
  DepthNormalImages reduced(device, camera.width, camera.height);
  ParallelFor(device,
              camera.width,
              camera.height,
              ReduceKernel{{view.hypotheses.depth.View(),
                            view.hypotheses.normal.View(),
                            view.MapIntrinsics(),
                            factor},
                           camera.GetIntrinsics(),
                           reduced.depth.View(),
                           reduced.normal.View()});
  return reduced;
}

}  // namespace tsar
