// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/compose.h"
#include "colmap_tsar/pipeline/refine_image.h"

#include "tests/cuda/cuda_test.h"

namespace tsar {
namespace {

// A discrete choice, such as a superpixel's plane, decides about many pixels.
constexpr double kMaxShare = 5e-3;

template <typename T>
std::vector<T> Pixels(const Image<T>& image) {
  return {image.begin(), image.end()};
}

TEST_F(CudaTest, ComposeMapAndRateConfidence) {
  ExpectAlike(
      "ComposeMap, RateConfidence",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        // Two walls, the nearer one in every third column of the raster.
        const ReducedRaster& raster = inputs.views.Raster();
        const Plane& wall = inputs.drawn.wall;
        const Image<Plane> superpixels(raster.width, raster.height, wall);
        Image<Plane> regions(raster.width, raster.height);
        for (int y = 0; y < raster.height; ++y) {
          for (int x = 0; x < raster.width; x += 3) {
            regions(x, y) = {wall.normal, 0.8f * wall.offset};
          }
        }
        const DeviceImage<Plane> superpixel_planes(device, superpixels);
        const DeviceImage<Plane> region_planes(device, regions);
        const auto on_map = [&](const DeviceImage<Plane>& planes) {
          return PlaneRaster{planes.View(),
                             inputs.views.MapIntrinsics(),
                             inputs.views.Width(),
                             inputs.views.Height()};
        };
        ComposedMap composed = ComposeMap(inputs.views.TakeHypotheses(),
                                          {inputs.reliable.View(),
                                           on_map(superpixel_planes),
                                           on_map(region_planes)},
                                          inputs.views.Scale(),
                                          {},
                                          device);
        MarkInterpolated(inputs.reliable.View(), &composed, device);
        result->Add("depth", kCloseDepths, composed.map.depth);
        result->Add("normal", kCloseScores, composed.map.normal);
        result->Add("provenance", kSameLabels, composed.provenance);
        result->Add("confidence",
                    kCloseScores,
                    RateConfidence(composed, inputs.score.View(), device));
      });
}

TEST_F(CudaTest, RefineImage) {
  std::vector<SceneSize> scenes = AllScenes();
  scenes.push_back({SceneKind::kWall, 331, 203});
  scenes.push_back({SceneKind::kWall, 223, 811});
  for (const bool paper : {false, true}) {
    ExpectAlike(
        paper ? "RefineImage, paper" : "RefineImage",
        scenes,
        [paper](StageInputs& inputs, Device& device, StageResult* result) {
          const RefineResult refined =
              RefineImage(inputs.drawn.views[0],
                          inputs.drawn.Sources(),
                          1,
                          paper ? RefineOptions::Paper() : RefineOptions(),
                          device);
          result->Add(
              "depth", {1e-4, 1e-6, kMaxShare}, Pixels(refined.maps.depth));
          result->Add(
              "normal", {0.0, 1e-3, kMaxShare}, Pixels(refined.maps.normal));
          result->Add("confidence",
                      {0.0, 1e-3, kMaxShare},
                      Pixels(refined.maps.confidence));
          result->Add("provenance",
                      {0.0, 0.0, kMaxShare},
                      Pixels(refined.maps.provenance));
        });
  }
}

}  // namespace
}  // namespace tsar
