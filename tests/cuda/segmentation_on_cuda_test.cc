// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/regions/assign_region_planes.h"
#include "colmap_tsar/view/regions/edges.h"
#include "colmap_tsar/view/regions/region_planes.h"

#include "tests/cuda/cuda_test.h"

namespace tsar {
namespace {

// Fields of 20 x 20 pixels between lines.
Regions FindFields(int width, int height, Device& device) {
  Image<uint8_t> edges(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      edges(x, y) = x % 21 == 20 || y % 21 == 20 ? 1 : 0;
    }
  }
  return FindRegions(DeviceImage<uint8_t>(device, edges).View(), 10, device);
}

TEST_F(CudaTest, DetectRobertsEdges) {
  ExpectAlike("DetectRobertsEdges",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                result->Add(
                    "edges",
                    DetectRobertsEdges(inputs.views.Color(), 4.f, device));
              });
}

TEST_F(CudaTest, DrawLineSegments) {
  // Both the noise of a mask and the edges of the synthetic wall.
  std::vector<SceneSize> scenes = AllScenes();
  scenes.push_back({SceneKind::kWall, 331, 203});
  ExpectAlike(
      "DrawLineSegments",
      scenes,
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const DeviceImage<uint8_t> edges =
            DetectRobertsEdges(inputs.views.Color(), 4.f, device);
        result->Add("edges", DrawLineSegments(edges.View(), {}, device));
        result->Add("noise",
                    DrawLineSegments(inputs.reliable.View(), {}, device));
      });
}

TEST_F(CudaTest, FindRegions) {
  ExpectAlike("FindRegions",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const Regions regions =
                    FindRegions(inputs.reliable.View(), 2, device);
                result->Add("labels", regions.labels);
                result->Add("count", std::vector<int>{regions.count});
              });
}

TEST_F(CudaTest, GrowAndShrinkLabels) {
  ExpectAlike(
      "GrowLabels, ShrinkLabels",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const Regions regions =
            FindFields(inputs.views.Width(), inputs.views.Height(), device);
        result->Add("grown", GrowLabels(regions.labels.View(), 5, device));
        result->Add("shrunk", ShrinkLabels(regions.labels.View(), 5, device));
      });
}

TEST_F(CudaTest, FitAndAssignRegionPlanes) {
  for (const bool use_core : {true, false}) {
    ExpectAlike(
        use_core ? "FitRegionPlanes, AssignRegionPlanes"
                 : "FitRegionPlanes, AssignRegionPlanes, no core",
        AllScenes(),
        [use_core](StageInputs& inputs, Device& device, StageResult* result) {
          const Regions regions = FindFields(inputs.views.Raster().width,
                                             inputs.views.Raster().height,
                                             device);
          RegionPlaneOptions options;
          options.use_core = use_core;
          options.min_samples = 20;
          const RegionPlanes fits = FitRegionPlanes(regions,
                                                    inputs.samples.View(),
                                                    inputs.views.Scale(),
                                                    options,
                                                    device);
          std::vector<Plane> planes;
          for (const SupportedPlane& fit : fits.planes.ToHost()) {
            planes.push_back(fit.plane);
          }
          result->Add("planes", planes);
          result->Add("pixels",
                      AssignRegionPlanes(regions,
                                         fits,
                                         inputs.samples.View(),
                                         inputs.views.RasterIntrinsics(),
                                         inputs.views.Scale(),
                                         options,
                                         device));
        });
  }
}

}  // namespace
}  // namespace tsar
