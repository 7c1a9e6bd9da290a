// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/superpixels/cielab.h"
#include "colmap_tsar/view/superpixels/correlation.h"
#include "colmap_tsar/view/superpixels/samples.h"
#include "colmap_tsar/view/superpixels/slic.h"
#include "colmap_tsar/view/superpixels/trust.h"

#include <algorithm>

#include "tests/cuda/cuda_test.h"

namespace tsar {
namespace {

std::vector<int> Channels(const DeviceImage<Rgb>& color) {
  std::vector<int> channels;
  for (const Rgb& pixel : color.ToHost()) {
    channels.insert(channels.end(), {pixel.r, pixel.g, pixel.b});
  }
  return channels;
}

// Numbers in {0, ..., num_labels - 1}, less shift.
DeviceImage<int> RandomLabels(const DeviceViews& views,
                              int num_labels,
                              int shift,
                              Device& device) {
  const Image<float> random = RandomImage(
      views.Width(), views.Height(), static_cast<float>(num_labels), 5);
  Image<int> labels(random.Width(), random.Height());
  for (size_t i = 0; i < random.NumPixels(); ++i) {
    labels.Data()[i] = static_cast<int>(random.Data()[i]) - shift;
  }
  return DeviceImage<int>(device, labels);
}

TEST_F(CudaTest, ReduceColor) {
  ExpectAlike(
      "ReduceColor",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const int width = inputs.views.Width();
        const int height = inputs.views.Height();
        const ReducedRaster same = {width, height};
        const ReducedRaster smaller = {(width + 2) / 3, (2 * height + 2) / 3};
        for (const ReducedRaster& raster : {same, smaller}) {
          result->Add(
              "color",
              Channels(ReduceColor(inputs.views.Color(), raster, device)));
        }
      });
}

TEST_F(CudaTest, ConvertToLab) {
  ExpectAlike("ConvertToLab",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                result->Add("lab", ConvertToLab(inputs.views.Color(), device));
              });
}

TEST_F(CudaTest, ComputeSuperpixels) {
  ExpectAlike(
      "ComputeSuperpixels",
      AllScenes(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        SlicOptions options;
        options.superpixel_size = 60;
        const Superpixels superpixels = ComputeSuperpixels(
            inputs.views.RasterColor(), inputs.score.View(), options, device);
        result->Add("labels", superpixels.labels);
        result->Add("count", std::vector<int>{superpixels.count});
      });
}

TEST_F(CudaTest, MergeFragments) {
  ExpectAlike("MergeFragments",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                DeviceImage<int> merged =
                    RandomLabels(inputs.views, 3, 0, device);
                const int count = MergeFragments(merged, 12, device);
                result->Add("labels", merged);
                result->Add("count", std::vector<int>{count});
              });
}

TEST_F(CudaTest, GroupPixels) {
  ExpectAlike("GroupPixels",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                // Some pixels are of no group, and some groups are empty.
                const DeviceImage<int> labels =
                    RandomLabels(inputs.views, 40, 3, device);
                for (const int num_labels : {37, 128, 5000}) {
                  const PixelGroups groups =
                      GroupPixels(labels.View(), num_labels, device);
                  result->Add("begin", groups.begin);
                  result->Add("pixels", groups.pixels);
                }
              });
}

void AddGroupPlanes(const PixelGroups& groups,
                    const StageInputs& inputs,
                    Device& device,
                    StageResult* result) {
  std::vector<Plane> planes;
  std::vector<int> counts;
  std::vector<Vec3f> supports;
  for (const GroupPlane& fit :
       FitGroupPlanes(
           groups, inputs.samples.View(), inputs.views.Scale(), {}, device)
           .ToHost()) {
    planes.push_back(fit.plane);
    counts.insert(
        counts.end(),
        {fit.num_pixels, fit.num_samples, fit.num_inliers, fit.num_near});
    supports.push_back(
        {fit.support.mean_x, fit.support.mean_y, fit.support.inverse_xx});
  }
  result->Add("planes", planes);
  result->Add("counts", counts);
  result->Add("supports", supports);
}

TEST_F(CudaTest, FitGroupPlanes) {
  ExpectAlike("FitGroupPlanes",
              AllScenes(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                AddGroupPlanes(GroupPixels(inputs.squares.labels.View(),
                                           inputs.squares.count,
                                           device),
                               inputs,
                               device,
                               result);
              });
}

TEST_F(CudaTest, FitGroupPlanesToLargeGroups) {
  // Some columns are of no group, and group 1 has no pixels.
  std::vector<SceneSize> scenes = AllScenes();
  scenes.push_back({SceneKind::kWall, 331, 203});
  int most_samples = 0;
  ExpectAlike(
      "FitGroupPlanes, large groups",
      scenes,
      [&](StageInputs& inputs, Device& device, StageResult* result) {
        const ReducedRaster& raster = inputs.views.Raster();
        Image<int> labels(raster.width, raster.height, 0);
        for (int y = 0; y < raster.height; ++y) {
          for (int x = 0; x < raster.width; ++x) {
            labels(x, y) = x % 11 == 10 ? -1 : (5 * x < raster.width ? 2 : 0);
          }
        }
        const PixelGroups groups =
            GroupPixels(DeviceImage<int>(device, labels).View(), 3, device);
        AddGroupPlanes(groups, inputs, device, result);
        const Image<RayDepth> samples = inputs.samples.ToHost();
        most_samples = std::max(
            most_samples,
            static_cast<int>(std::count_if(
                samples.begin(), samples.end(), [](const RayDepth& sample) {
                  return sample.z > 0.f;
                })));
      });
  // Hypotheses are scored on a share of them.
  EXPECT_GT(most_samples, 4 * GroupPlaneOptions().max_scored_samples);
}

TEST_F(CudaTest, FitSuperpixelPlanes) {
  ExpectAlike("FitSuperpixelPlanes",
              AllScenes(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                result->Add("planes",
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
                result->Add("depth", filtered.depth);
                result->Add("normal", filtered.normal);
              });
}

TEST_F(CudaTest, SampleMeasurementsAndReduceNearest) {
  ExpectAlike(
      "SampleMeasurements, ReduceNearest",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        result->Add("samples", inputs.samples);
        result->Add(
            "reduced",
            ReduceNearest(inputs.score.View(), inputs.views.Raster(), device));
      });
}

TEST_F(CudaTest, PlanesOfLabels) {
  ExpectAlike(
      "PlanesOfLabels",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        std::vector<Plane> planes;
        for (int k = 0; k < inputs.squares.count; ++k) {
          const float tilt = 0.05f * static_cast<float>(k % 7);
          planes.push_back(k % 5 == 4 ? Plane{}
                                      : DrawnPlane({tilt, 0.f, -1.f}, 4.f));
        }
        const Buffer<Plane> buffer(device, planes);
        result->Add(
            "planes",
            PlanesOfLabels(inputs.squares.labels.View(), buffer, device));
        const Image<int> labels = inputs.squares.labels.ToHost();
        Image<uint16_t> numbers(labels.Width(), labels.Height());
        std::copy(labels.begin(), labels.end(), numbers.begin());
        result->Add(
            "planes by number",
            PlanesOfLabels(
                DeviceImage<uint16_t>(device, numbers).View(), buffer, device));
      });
}

TEST_F(CudaTest, RefineByCorrelation) {
  struct Variant {
    std::string name;
    bool readmit_filtered;
    bool use_superpixel_planes;
    bool use_weighted_median;
  };
  for (const Variant& variant : {Variant{"as usual", false, true, true},
                                 Variant{"readmitting", true, true, true},
                                 Variant{"no planes", true, false, true},
                                 Variant{"no median", false, true, false},
                                 Variant{"neither", true, false, false}}) {
    ExpectAlike("RefineByCorrelation, " + variant.name,
                AllScenes(),
                [&](StageInputs& inputs, Device& device, StageResult* result) {
                  CorrelationOptions options;
                  options.readmit_filtered = variant.readmit_filtered;
                  options.use_superpixel_planes = variant.use_superpixel_planes;
                  options.use_weighted_median = variant.use_weighted_median;
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
                  result->Add("trusted", refined.trusted);
                  result->Add("planes", refined.planes);
                });
  }
}

// Depths that are up to a tenth off: some pass a gate about the drawn planes
// and some do not.
struct DrawnGate {
  DrawnGate(const StageInputs& inputs, bool readmit_filtered, Device& device) {
    const ViewData& view = inputs.drawn.views[0];
    const Intrinsics intrinsics = inputs.views.MapIntrinsics();
    const Image<float> noise =
        RandomImage(inputs.views.Width(), inputs.views.Height(), 0.2f, 9);
    Image<InverseDepthPlane> planes(noise.Width(), noise.Height());
    Image<float> depths(noise.Width(), noise.Height());
    for (int y = 0; y < noise.Height(); ++y) {
      for (int x = 0; x < noise.Width(); ++x) {
        planes(x, y) = ToInverseDepth(
            intrinsics.Ray(x, y), view.depth(x, y), view.normal(x, y));
        depths(x, y) = view.depth(x, y) * (0.9f + noise(x, y));
      }
    }
    estimate = DeviceImage<InverseDepthPlane>(device, planes);
    own_depth = DeviceImage<float>(device, depths);
    gate = {own_depth.View(),
            inputs.score.View(),
            inputs.views.Scale(),
            6.f,
            readmit_filtered};
  }

  DeviceImage<InverseDepthPlane> estimate;
  DeviceImage<float> own_depth;
  TrustGate gate;
};

TEST_F(CudaTest, GateByPlanes) {
  for (const bool readmit : {false, true}) {
    ExpectAlike(readmit ? "GateByPlanes, readmitting" : "GateByPlanes",
                AllScenesAndWide(),
                [&](StageInputs& inputs, Device& device, StageResult* result) {
                  const DrawnGate drawn(inputs, readmit, device);
                  GateByPlanes(drawn.estimate.View(),
                               inputs.views.MapIntrinsics(),
                               drawn.gate,
                               inputs.reliable.View(),
                               device);
                  result->Add("trusted", inputs.reliable);
                });
  }
}

TEST_F(CudaTest, GateByWeightedMedian) {
  for (const bool readmit : {false, true}) {
    ExpectAlike(
        readmit ? "GateByWeightedMedian, readmitting" : "GateByWeightedMedian",
        AllScenesAndWide(),
        [&](StageInputs& inputs, Device& device, StageResult* result) {
          const DrawnGate drawn(inputs, readmit, device);
          WeightedMedianOptions options;
          // Neighboring taps, and taps that are far apart.
          options.radius = readmit ? 5.f : 40.f;
          GateByWeightedMedian(drawn.estimate.View(),
                               inputs.views.Color(),
                               inputs.views.MapIntrinsics(),
                               options,
                               drawn.gate,
                               inputs.reliable.View(),
                               device);
          result->Add("trusted", inputs.reliable);
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
                            InterpolateHoles(inputs.views.Color(),
                                             inputs.views.MapIntrinsics(),
                                             3,
                                             first,
                                             &map,
                                             device));
                result->Add("depth", map.depth);
                result->Add("normal", map.normal);
              });
}

}  // namespace
}  // namespace tsar
