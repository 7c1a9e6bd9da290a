// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/superpixel_surfaces.h"

#include <cstddef>
#include <cstdint>

namespace tsar {

std::vector<Plane> PlanesOfSuperpixels(const LabeledView& labeled) {
  std::vector<Plane> planes;
  for (const int label : labeled.labels) {
    planes.push_back(label >= 0 ? labeled.planes[static_cast<size_t>(label)]
                                : Plane{});
  }
  return planes;
}

LabeledView FlattenSurfaces(const ObservedView& view,
                            LabeledView labeled,
                            const CurvedView& curved) {
  if (curved.surfaces.empty()) {
    return labeled;
  }
  const Image<uint16_t>& superpixels = view.evidence->superpixels;
  struct Sum {
    double x = 0.0;
    double y = 0.0;
    int count = 0;
  };
  std::vector<Sum> sums(labeled.labels.size());
  for (int y = 0; y < superpixels.Height(); ++y) {
    for (int x = 0; x < superpixels.Width(); ++x) {
      Sum& sum = sums[superpixels(x, y)];
      sum.x += x;
      sum.y += y;
      ++sum.count;
    }
  }
  const Intrinsics intrinsics = view.camera.GetIntrinsics();
  for (size_t k = 0; k < sums.size(); ++k) {
    if (curved.labels[k] < 0 || sums[k].count == 0) {
      continue;
    }
    const Plane tangent =
        curved.surfaces[static_cast<size_t>(curved.labels[k])].TangentAt(
            intrinsics.Ray(static_cast<float>(sums[k].x / sums[k].count),
                           static_cast<float>(sums[k].y / sums[k].count)));
    if (tangent.Valid()) {
      labeled.labels[k] = static_cast<int>(labeled.planes.size());
      labeled.planes.push_back(tangent);
    }
  }
  return labeled;
}

std::vector<ComposedSuperpixel> RateSuperpixels(const FoundScene& found) {
  const LabeledView& labeled = found.labeled;
  const CurvedView& curved = found.curved;
  std::vector<ComposedSuperpixel> result;
  for (size_t k = 0; k < curved.evidence.size(); ++k) {
    const bool is_curved = !curved.labels.empty() && curved.labels[k] >= 0;
    const int label = labeled.labels[k];
    result.push_back(
        {curved.evidence[k],
         is_curved ? kConfidenceOfCurved
                   : RateSurface(curved.evidence[k], labeled.qualities[k]),
         label >= 0 ? found.plane_errors[static_cast<size_t>(label)]
                    : InverseDepthError{},
         is_curved});
  }
  return result;
}

}  // namespace tsar
