// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/refinement/correlation.h"
#include "colmap_tsar/refinement/fragments.h"

#include "tests/cuda/cuda_test.h"

namespace tsar {
namespace {

TEST_F(CudaTest, ComputeSuperpixels) {
  ExpectAlike(
      "ComputeSuperpixels",
      AllScenes(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        SlicOptions options;
        options.superpixel_size = 60;
        const Superpixels superpixels = ComputeSuperpixels(
            inputs.views.RasterColor(), inputs.score.View(), options, device);
        result->Add("labels", kSameLabels, superpixels.labels);
        result->Add("count", kSameLabels, std::vector<int>{superpixels.count});
      });
}

TEST_F(CudaTest, MergeFragments) {
  ExpectAlike("MergeFragments",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                Image<float> random = RandomImage(
                    inputs.views.Width(), inputs.views.Height(), 3.f, 5);
                Image<int> labels(random.Width(), random.Height());
                for (size_t i = 0; i < random.NumPixels(); ++i) {
                  labels.Data()[i] = static_cast<int>(random.Data()[i]);
                }
                DeviceImage<int> merged(device, labels);
                const int count = MergeFragments(merged, 12, device);
                result->Add("labels", kSameLabels, merged);
                result->Add("count", kSameLabels, std::vector<int>{count});
              });
}

TEST_F(CudaTest, GroupPixels) {
  ExpectAlike("GroupPixels",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const PixelGroups groups = GroupPixels(
                    inputs.squares.labels.View(), inputs.squares.count, device);
                result->Add("begin", kSameLabels, groups.begin);
                result->Add("pixels", kSameLabels, groups.pixels);
              });
}

TEST_F(CudaTest, FitGroupPlanes) {
  ExpectAlike(
      "FitGroupPlanes",
      AllScenes(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const PixelGroups groups = GroupPixels(
            inputs.squares.labels.View(), inputs.squares.count, device);
        const std::vector<GroupPlane> fits =
            FitGroupPlanes(
                groups, inputs.samples.View(), inputs.views.Scale(), {}, device)
                .ToHost();
        std::vector<Plane> planes;
        std::vector<int> counts;
        std::vector<Vec3f> supports;
        for (const GroupPlane& fit : fits) {
          planes.push_back(fit.plane);
          counts.insert(
              counts.end(),
              {fit.num_pixels, fit.num_samples, fit.num_inliers, fit.num_near});
          supports.push_back(
              {fit.support.mean_x, fit.support.mean_y, fit.support.inverse_xx});
        }
        result->Add("planes", kCloseDepths, planes);
        result->Add("counts", kSameLabels, counts);
        result->Add("supports", {1e-3, 1e-4, 1e-3}, supports);
      });
}

TEST_F(CudaTest, FitSuperpixelPlanes) {
  ExpectAlike("FitSuperpixelPlanes",
              AllScenes(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                result->Add("planes",
                            kCloseDepths,
                            FitSuperpixelPlanes(
                                GroupPixels(inputs.squares.labels.View(),
                                            inputs.squares.count,
                                            device),
                                                inputs.samples.View(),
                                                inputs.views.RasterIntrinsics(),
                                                inputs.views.Scale(),
                                                {},
                                                device));
              });
}

TEST_F(CudaTest, WeightedMedianFilter) {
  ExpectAlike("WeightedMedianFilter",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const DepthNormalImages filtered =
                    WeightedMedianFilter(inputs.views.Hypotheses(),
                                         inputs.views.Color(),
                                         inputs.reliable.View(),
                                         inputs.views.MapIntrinsics(),
                                         {},
                                         device);
                result->Add("depth", kCloseDepths, filtered.depth);
                result->Add("normal", kCloseScores, filtered.normal);
              });
}

TEST_F(CudaTest, SampleMeasurementsAndReduceNearest) {
  ExpectAlike(
      "SampleMeasurements, ReduceNearest",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        result->Add("samples", kCloseDepths, inputs.samples);
        result->Add(
            "reduced",
            kSameLabels,
            ReduceNearest(inputs.score.View(), inputs.views.Raster(), device));
      });
}

TEST_F(CudaTest, PlanesOfLabels) {
  ExpectAlike("PlanesOfLabels",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                std::vector<Plane> planes;
                for (int k = 0; k < inputs.squares.count; ++k) {
                  const float tilt = 0.05f * static_cast<float>(k % 7);
                  planes.push_back(k % 5 == 4
                                       ? Plane{}
                                       : DrawnPlane({tilt, 0.f, -1.f}, 4.f));
                }
                const Buffer<Plane> buffer(device, planes);
                const DeviceImage<Plane> of_pixels = PlanesOfLabels(
                    inputs.squares.labels.View(), buffer, device);
                const Image<Plane> host = of_pixels.ToHost();
                result->Add("planes",
                            kSameLabels,
                            std::vector<Plane>(host.begin(), host.end()));
              });
}

TEST_F(CudaTest, RefineByCorrelation) {
  for (const bool readmit : {false, true}) {
    ExpectAlike(
        readmit ? "RefineByCorrelation, readmit" : "RefineByCorrelation",
        AllScenes(),
        [readmit](StageInputs& inputs, Device& device, StageResult* result) {
          CorrelationOptions options;
          options.readmit_filtered = readmit;
          const CorrelationResult refined =
              RefineByCorrelation(inputs.views.Hypotheses(),
                                  inputs.score.View(),
                                  std::move(inputs.reliable),
                                  inputs.views.Color(),
                                  inputs.squares,
                                  inputs.views.Raster(),
                                  inputs.views.ReferenceCamera(),
                                  inputs.views.Scale(),
                                  options,
                                  device);
          result->Add("trusted", kSameLabels, refined.trusted);
          result->Add("planes", kCloseDepths, refined.planes);
        });
  }
}

TEST_F(CudaTest, InterpolateHoles) {
  ExpectAlike("InterpolateHoles",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const ViewData& reference = inputs.drawn.views[0];
                DepthNormalImages map;
                map.depth = DeviceImage<float>(device, reference.depth);
                map.normal = DeviceImage<Vec3f>(device, reference.normal);
                WeightedMedianOptions first;
                first.radius = 3.f;
                first.min_support = 1.f / 3.f;
                result->Add("filled",
                            kSameLabels,
                            InterpolateHoles(inputs.views.Color(),
                                             inputs.views.MapIntrinsics(),
                                             3,
                                             first,
                                             &map,
                                             device));
                result->Add("depth", kCloseDepths, map.depth);
                result->Add("normal", kCloseScores, map.normal);
              });
}

}  // namespace
}  // namespace tsar
