// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/scene/surfaces/rasterize_curved_surfaces.h"

#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <algorithm>
#include <memory>

#include "tests/scene/surfaces/curved_surfaces_fixture.h"
#include "tests/support/synthetic_scene.h"
#include <gtest/gtest.h>

namespace tsar {
namespace {

TEST_F(CurvedSurfacesTest, RasterizesTangentsWhereSurfacesAre) {
  const Plane wall = DrawnPlane({0.f, 0.f, -1.f}, 5.f);
  CurvedView view;
  view.surfaces = {{0.f, 0.f, 1.f, {0.25f, 0.f, 0.f, 0.1f, 0.f, 0.f}}};
  view.labels = {-1, 0};
  const Image<uint16_t> superpixels = [] {
    Image<uint16_t> labels(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = kWidth / 2; x < kWidth; ++x) {
        labels(x, y) = 1;
      }
    }
    return labels;
  }();
  for (const int num_threads : {1, 4}) {
    const std::unique_ptr<Device> device = Device::CreateCpu(num_threads);
    DeviceImage<Plane> planes(*device, Image<Plane>(kWidth, kHeight, wall));
    RasterizeCurvedSurfaces(
        view, superpixels, inputs_.intrinsics, *device, &planes);
    const Image<Plane> put = planes.ToHost();
    for (const int x : {0, kWidth / 2 - 1, kWidth / 2, kWidth - 1}) {
      const Plane expected =
          x < kWidth / 2
              ? wall
              : view.surfaces[0].TangentAt(inputs_.intrinsics.Ray(x, 7));
      EXPECT_EQ(put(x, 7).normal, expected.normal);
      EXPECT_EQ(put(x, 7).offset, expected.offset);
    }
  }
}

}  // namespace
}  // namespace tsar
