// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/reduce_hypotheses.h"

#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/pipeline/reduce_view.h"
#include "colmap_tsar/pipeline/square_hypothesis.h"

namespace tsar {
namespace {

struct ReduceKernel {
  SquareHypothesis squares;
  Intrinsics reduced;
  ImageView<float> depth;
  ImageView<Vec3f> normal;

  TSAR_HD void operator()(int x, int y) const {
    depth(x, y) = 0.f;
    normal(x, y) = {};
    const ptrdiff_t found = squares.Find(x, y);
    if (found >= 0) {
      depth(x, y) = squares.DepthOnRay(
          found, reduced.Ray(static_cast<float>(x), static_cast<float>(y)));
      normal(x, y) = squares.normal.data[found];
    }
  }
};

}  // namespace

DepthNormalImages ReduceHypotheses(const DeviceReference& view,
                                   const Image<uint8_t>& is_to_refine,
                                   int factor,
                                   Device& device) {
  const Camera camera = ReduceCamera(view.camera, factor);
  const DeviceImage<uint8_t> to_refine(device, is_to_refine);
  DepthNormalImages reduced(device, camera.width, camera.height);
  ParallelFor(device,
              camera.width,
              camera.height,
              ReduceKernel{{view.hypotheses.depth.View(),
                            view.hypotheses.normal.View(),
                            to_refine.View(),
                            view.MapIntrinsics(),
                            factor},
                           camera.GetIntrinsics(),
                           reduced.depth.View(),
                           reduced.normal.View()});
  return reduced;
}

}  // namespace tsar
