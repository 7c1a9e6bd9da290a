// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/compose/apply_cylinders.h"
#include "colmap_tsar/compose/compose_scene.h"
#include "colmap_tsar/compose/depth_sigma.h"
#include "colmap_tsar/compose/photometric_detail.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/compose/transfer_flags.h"
#include "colmap_tsar/device/parallel_for.h"
#include "colmap_tsar/view/compose.h"
#include "colmap_tsar/view/reduce_view.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/cuda/cuda_test.h"

namespace tsar {
namespace {

template <typename T>
std::vector<T> Pixels(const Image<T>& image) {
  return {image.begin(), image.end()};
}

TEST_F(CudaTest, ComposeMapAndRateConfidence) {
  ExpectAlike(
      "ComposeMap, ComputeComposedConfidence, ComputeSigma",
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
        result->Add("depth", composed.map.depth);
        result->Add("normal", composed.map.normal);
        result->Add("provenance", composed.provenance);
        result->Add(
            "confidence",
            ComputeComposedConfidence(composed, inputs.score.View(), device));
        result->Add("sigma",
                    ComputeSigma(composed, inputs.views.Scale(), {}, device));
      });
}

TEST_F(CudaTest, ComposeSceneAndRateSceneConfidence) {
  std::set<Provenance> found;
  ExpectAlike(
      "ComposeScene, ComputeSceneConfidence, ComputeSceneSigma",
      AllScenesAndWide(),
      [&](StageInputs& inputs, Device& device, StageResult* result) {
        const ReducedRaster& raster = inputs.views.Raster();
        const Plane& wall = inputs.drawn.wall;
        const Plane nearer = {wall.normal, 0.8f * wall.offset};
        // In squares: the wall; one off which the depths lie; none.
        Image<Plane> scene(raster.width, raster.height);
        Image<uint16_t> superpixels(raster.width, raster.height);
        Philox random(22, 0, 0);
        for (int y = 0; y < raster.height; ++y) {
          for (int x = 0; x < raster.width; ++x) {
            const int square = x / 16 + y / 16;
            scene(x, y) = square % 3 == 0   ? wall
                          : square % 3 == 1 ? nearer
                                            : Plane{};
            superpixels(x, y) = static_cast<uint16_t>(random.NextBelow(40));
          }
        }
        std::vector<ComposedSuperpixel> of_superpixel;
        for (int k = 0; k < 40; ++k) {
          of_superpixel.push_back(
              {static_cast<LabelEvidence>(k % 4),
               {0.01f * k, 0.02f * k, 0.025f * k, 0.03f * k},
               {1e-5f * k, 2e-6f, -3e-6f, 1e-6f * k, 4e-6f, 5e-6f},
               k % 5 == 0 ? wall.normal : Vec3f{}});
        }
        // Three depths of four are trusted.
        Image<uint8_t> flags(inputs.views.Width(), inputs.views.Height());
        for (uint8_t& value : flags) {
          const uint32_t number = random.NextBelow(340);
          value = static_cast<uint8_t>(number < 256 ? number : 0);
        }
        // Sources a little to the right, which see the wall and, in squares,
        // something nearer.
        ViewEvidence evidence;
        evidence.width = raster.width;
        evidence.height = raster.height;
        evidence.superpixels = superpixels;
        evidence.confident_depth = Image<float>(raster.width, raster.height);
        evidence.color = Image<Rgb>(raster.width, raster.height);
        for (Rgb& pixel : evidence.color) {
          const auto level = static_cast<uint8_t>(random.NextBelow(30));
          pixel = {level, 100, level};
        }
        Camera camera =
            inputs.views.ReferenceCamera().Resized(raster.width, raster.height);
        std::vector<ObservedView> observed = {{&evidence, camera}};
        std::vector<std::vector<Plane>> planes_of_sources;
        for (int source = 0; source < 2; ++source) {
          camera.translation.x() -= 0.05 * wall.offset;
          observed.push_back({&evidence, camera});
          planes_of_sources.emplace_back(40, wall);
          for (size_t k = 0; k < 40; k += 3) {
            planes_of_sources[source][k] = nearer;
          }
        }
        const DeviceImage<float> device_texture(
            device, Image<float>(raster.width, raster.height, 7.f));
        const DeviceImage<uint8_t> device_flags(device, flags);
        const DeviceImage<Plane> scene_planes(device, scene);
        const DeviceImage<uint16_t> device_superpixels(device, superpixels);
        const Buffer<ComposedSuperpixel> device_of_superpixel(device,
                                                              of_superpixel);
        const ComposeSceneInputs scene_inputs{device_flags.View(),
                                              inputs.views.OnMap(scene_planes),
                                              device_superpixels.View(),
                                              device_of_superpixel.Data(),
                                              device_texture.View()};
        const ViewSurfaces surfaces{observed, planes_of_sources};
        ComposedMap composed = ComposeScene(inputs.views.TakeHypotheses(),
                                            scene_inputs,
                                            surfaces,
                                            inputs.views.Scale(),
                                            {},
                                            device);
        result->Add("depth", composed.map.depth);
        result->Add("normal", composed.map.normal);
        result->Add("provenance", composed.provenance);
        const auto confidence_of = [&] {
          return ComputeSceneConfidence(composed,
                                        scene_inputs,
                                        surfaces,
                                        inputs.views.Scale(),
                                        0.2f,
                                        0.3f,
                                        device);
        };
        result->Add("confidence", confidence_of());
        const auto sigma = [&] {
          return ComputeSceneSigma(
              composed, scene_inputs, inputs.views.Scale(), 0.2f, {}, device);
        };
        result->Add("sigma", sigma());
        for (const uint8_t value : composed.provenance.ToHost()) {
          found.insert(static_cast<Provenance>(value));
        }
        MarkInterpolated(inputs.reliable.View(), &composed, device);
        DeviceImage<float> confidence = confidence_of();
        result->Add("confidence of filled pixels", confidence);
        // A prior on one half of the raster.
        Image<float> prior(raster.width, raster.height);
        for (int y = 0; y < raster.height; ++y) {
          for (int x = 0; x < raster.width / 2; ++x) {
            prior(x, y) = (1.1f + 0.001f * (x + y)) * wall.offset;
          }
        }
        const DeviceImage<float> prior_depth(device, prior);
        const DeviceImage<float> prior_sigma(
            device, Image<float>(raster.width, raster.height, 0.02f));
        ComposeSceneInputs with_prior = scene_inputs;
        with_prior.prior = {prior_depth.View(),
                            prior_sigma.View(),
                            0.1f,
                            inputs.views.MapIntrinsics(),
                            confidence.Width(),
                            confidence.Height()};
        FillByPrior(with_prior, 0.3f, &composed, &confidence, device);
        result->Add("depth with a prior", composed.map.depth);
        result->Add("normal with a prior", composed.map.normal);
        result->Add("provenance with a prior", composed.provenance);
        result->Add("confidence with a prior", confidence);
        DropDoubtful(0.35f, &composed, &confidence, device);
        result->Add("depth above a confidence", composed.map.depth);
        result->Add("confidence above a limit", confidence);
        result->Add("sigma above a limit", sigma());
      });
  EXPECT_EQ(found,
            (std::set<Provenance>{Provenance::kNone,
                                  Provenance::kMeasured,
                                  Provenance::kRegionPlane,
                                  Provenance::kOtherViews,
                                  Provenance::kGuessed}));
}

TEST_F(CudaTest, ApplyCylindersAndSetTheirConfidence) {
  ExpectAlike(
      "ApplyCylinders, SetConfidenceOfCylinders, SetSigmaOfCylinders",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const int width = inputs.views.Width();
        const int height = inputs.views.Height();
        // Upright, seen in every other eighth, in two sizes.
        std::vector<SeenCylinder> cylinders(2);
        for (int k = 0; k < 2; ++k) {
          SeenCylinder& seen = cylinders[k];
          const float distance = inputs.drawn.wall.offset * (0.5f + 0.2f * k);
          seen.cylinder = {{0.1f * k * distance, -distance, distance},
                           {0.f, 1.f, 0.f},
                           0.2f * distance};
          seen.length = 2.f * distance;
          for (int bin = 0; bin < SeenCylinder::kNumBins; ++bin) {
            seen.is_seen[bin] = (8 * bin / SeenCylinder::kNumBins + k) % 2;
          }
          seen.across = {1.f, 0.f, 0.f};
          seen.third = {0.f, 0.f, 1.f};
          seen.variances[0] = 1e-4f;
          seen.variances[1] = 2e-4f;
          seen.variances[2] = 3e-4f;
          seen.covariances[1] = -5e-5f;
        }
        ComposedMap composed{
            inputs.views.TakeHypotheses(),
            DeviceImage<uint8_t>(
                device,
                Image<uint8_t>(width,
                               height,
                               static_cast<uint8_t>(Provenance::kMeasured)))};
        // All kinds of flags.
        Image<uint8_t> flags(width, height);
        Philox random(24, 0, 0);
        for (uint8_t& of_pixel : flags) {
          of_pixel = static_cast<uint8_t>(random.NextBelow(256));
        }
        const DeviceImage<uint8_t> device_flags(device, flags);
        const AppliedCylinders applied =
            ApplyCylinders(cylinders,
                           device_flags.View(),
                           inputs.views.MapIntrinsics(),
                           inputs.views.Scale(),
                           &composed,
                           device);
        result->Add("depth", composed.map.depth);
        result->Add("normal", composed.map.normal);
        result->Add("provenance", composed.provenance);
        DeviceImage<float> confidence(device, Image<float>(width, height));
        SetConfidenceOfCylinders(applied, &confidence, device);
        result->Add("confidence", confidence);
        DeviceImage<uint16_t> sigma(device, Image<uint16_t>(width, height));
        SetSigmaOfCylinders(applied,
                            inputs.views.MapIntrinsics(),
                            inputs.views.Scale(),
                            composed.map,
                            {},
                            &sigma,
                            device);
        result->Add("sigma", sigma);
      });
}

TEST_F(CudaTest, TransferFlags) {
  ExpectAlike("TransferFlags",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const ViewData& view = inputs.drawn.views[0];
                for (const int factor : {1, 2, 3}) {
                  const ViewData reduced = ReduceView(view, factor);
                  Image<uint8_t> flags(reduced.depth.Width(),
                                       reduced.depth.Height());
                  Philox random(23, 0, 0);
                  for (uint8_t& of_pixel : flags) {
                    of_pixel = static_cast<uint8_t>(random.NextBelow(256));
                  }
                  const DeviceImage<uint8_t> device_flags(device, flags);
                  const DeviceImage<float> depth(device, reduced.depth);
                  const DeviceImage<Vec3f> normal(device, reduced.normal);
                  result->Add("flags by " + std::to_string(factor),
                              TransferFlags({device_flags.View(),
                                             {depth.View(), normal.View()},
                                             reduced.camera.GetIntrinsics(),
                                             factor},
                                            inputs.views.Hypotheses().depth,
                                            inputs.views.MapIntrinsics(),
                                            inputs.views.Scale(),
                                            device));
                }
              });
}

TEST_F(CudaTest, ReduceHypotheses) {
  ExpectAlike("ReduceHypotheses",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const ViewData& view = inputs.drawn.views[0];
                const DeviceReference uploaded(view, device);
                for (const int factor : {2, 3, 7}) {
                  const DepthNormalImages reduced = ReduceHypotheses(
                      uploaded, view.is_to_refine, factor, device);
                  result->Add("depth", reduced.depth);
                  result->Add("normal", reduced.normal);
                }
              });
}

TEST_F(CudaTest, RestoreDetail) {
  size_t num_moved = 0;
  ExpectAlike(
      "RestoreDetail",
      AllScenesAndWide(),
      [&](StageInputs& inputs, Device& device, StageResult* result) {
        const ViewData& view = inputs.drawn.views[0];
        // A little in front of the wall, where three pixels of four
        // were measured.
        Image<float> depth = view.depth;
        Image<uint8_t> provenance(depth.Width(), depth.Height());
        Philox random(24, 0, 0);
        for (size_t i = 0; i < depth.NumPixels(); ++i) {
          if (depth.Data()[i] > 0.f) {
            depth.Data()[i] = DepthAtOffset(
                inputs.drawn.truth.Data()[i], 0.15f, inputs.views.Scale());
          }
          provenance.Data()[i] = static_cast<uint8_t>(
              random.NextBelow(4) != 0 ? Provenance::kMeasured
                                       : Provenance::kOtherViews);
        }
        ComposedMap composed;
        composed.map.depth = DeviceImage<float>(device, depth);
        composed.map.normal = DeviceImage<Vec3f>(device, view.normal);
        composed.provenance = DeviceImage<uint8_t>(device, provenance);
        RestoreDetail(DeviceReference(view, device),
                      UploadViews(inputs.drawn.Sources(), device),
                      inputs.views.Scale(),
                      {},
                      &composed,
                      device);
        result->Add("depth", composed.map.depth);
        const Image<float> restored = composed.map.depth.ToHost();
        for (size_t i = 0; i < depth.NumPixels(); ++i) {
          num_moved += restored.Data()[i] != depth.Data()[i] ? 1 : 0;
        }
      });
  EXPECT_GT(num_moved, 10000u);
}

// Notes what it is shown, and the inputs, which every device has alike.
class NotingObserver : public StageObserver {
 public:
  void Show(RefineStage stage, const Image<Rgb>&) override { Note(stage); }
  void Show(RefineStage stage, const Image<float>& values) override {
    Note(stage);
    if (stage == RefineStage::kDepthInput) {
      depth = Pixels(values);
    }
  }
  void Show(RefineStage stage, const Image<Vec3f>& values) override {
    Note(stage);
    if (stage == RefineStage::kNormalsInput) {
      normals = Pixels(values);
    }
  }
  void Show(RefineStage stage, const Image<uint8_t>&) override { Note(stage); }
  void Show(RefineStage stage, const Image<int>&) override { Note(stage); }
  void Show(RefineStage stage, const Image<Plane>&) override { Note(stage); }

  std::vector<int> stages;
  std::vector<float> depth;
  std::vector<Vec3f> normals;

 private:
  void Note(RefineStage stage) { stages.push_back(static_cast<int>(stage)); }
};

TEST_F(CudaTest, ObserversSeeWhatLiesInTheDevicesMemory) {
  ExpectAlike("StageObserver",
              AllScenes(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                NotingObserver observer;
                RefineImage(inputs.drawn.views[0],
                            UploadViews(inputs.drawn.Sources(), device),
                            1,
                            RefineOptions(),
                            device,
                            &observer);
                result->Add("stages", observer.stages);
                result->Add("depth", observer.depth);
                result->Add("normals", observer.normals);
              });
}

TEST_F(CudaTest, RefineImage) {
  std::vector<SceneSize> scenes = AllScenes();
  scenes.push_back({SceneKind::kWall, 331, 203});
  scenes.push_back({SceneKind::kWall, 223, 811});
  const std::vector<std::pair<std::string, RefineOptions>> presets = {
      {"default", RefineOptions()},
      {"paper", PresetOptions(RefinePreset::kPaper)}};
  for (const auto& [name, options] : presets) {
    ExpectAlike("RefineImage, " + name,
                scenes,
                [&options = options](
                    StageInputs& inputs, Device& device, StageResult* result) {
                  const RefineResult refined =
                      RefineImage(inputs.drawn.views[0],
                                  UploadViews(inputs.drawn.Sources(), device),
                                  1,
                                  options,
                                  device);
                  result->Add("depth", Pixels(refined.maps.depth));
                  result->Add("normal", Pixels(refined.maps.normal));
                  result->Add("confidence", Pixels(refined.maps.confidence));
                  result->Add("sigma", Pixels(refined.maps.sigma));
                  result->Add("provenance", Pixels(refined.maps.provenance));
                });
  }
}

}  // namespace
}  // namespace tsar
