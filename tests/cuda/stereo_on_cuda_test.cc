// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/plane_maps.h"
#include "colmap_tsar/tools/stereo/planar_prior.h"

#include <cmath>
#include <utility>
#include <vector>

#include "tests/cuda/cuda_test.h"
#include "tests/matching/textured_plane.h"

namespace tsar {
namespace {

// The wall is five units off.
PatchMatchOptions BoundsAroundTheWall() {
  PatchMatchOptions options;
  options.depth_min = 2.5f;
  options.depth_max = 10.f;
  return options;
}

// The sources' images; with their depths costs have the geometric term.
Buffer<SourceView> Sources(const StageInputs& inputs,
                           bool with_depth,
                           Device& device) {
  std::vector<SourceView> sources = inputs.views.Sources().ToHost();
  for (SourceView& source : sources) {
    if (!with_depth) {
      source.depth = {};
    }
  }
  return Buffer<SourceView>(device, sources);
}

DeviceImage<Plane> PlanesOfTheMaps(const StageInputs& inputs, Device& device) {
  const DepthNormalViews maps = inputs.views.Hypotheses();
  return PlanesFromMaps(
      inputs.views.MapIntrinsics(), maps.depth, maps.normal, device);
}

TEST_F(CudaTest, DrawPlanesAndConvertThem) {
  ExpectAlike(
      "DrawPlanes, ResizePlanes, MapsFromPlanes, PlanesFromMaps",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const Intrinsics intrinsics = inputs.views.MapIntrinsics();
        const int width = inputs.views.Width();
        const int height = inputs.views.Height();
        const DeviceImage<Plane> drawn = DrawPlanes(
            intrinsics, width, height, 3, BoundsAroundTheWall(), device);
        result->Add("drawn", drawn);
        const DeviceImage<Plane> planes = PlanesOfTheMaps(inputs, device);
        result->Add("planes", planes);
        result->Add(
            "resized",
            ResizePlanes(
                planes.View(), (width + 1) / 2, 2 * height + 1, device));
        const PlaneMaps maps =
            MapsFromPlanes(intrinsics, planes.View(), device);
        result->Add("depth", maps.depth);
        result->Add("normal", maps.normal);
      });
}

// The costs that planes start with.
TEST_F(CudaTest, FirstCostsOfPatchMatch) {
  for (const bool with_depth : {false, true}) {
    ExpectAlike(with_depth ? "first costs with depths" : "first costs",
                AllScenesAndWide(),
                [&](StageInputs& inputs, Device& device, StageResult* result) {
                  PatchMatchOptions options = BoundsAroundTheWall();
                  options.num_iterations = 0;
                  const PlaneHypotheses found =
                      RunPatchMatch({inputs.views.Reference(),
                                     Sources(inputs, with_depth, device),
                                     1},
                                    PlanesOfTheMaps(inputs, device),
                                    options,
                                    device);
                  result->Add("costs", found.costs);
                });
  }
}

constexpr int kWidth = 97;
constexpr int kHeight = 61;

// A drawn plane and four sources that see it, in the host's memory.
TexturedPlane DrawTexturedPlane(Device& cpu) {
  const Camera camera = SyntheticCamera(kWidth, kHeight, 120.0);
  TexturedPlane scene(DrawnPlane({0.3f, -0.2f, -1.f}, 3.f), camera, cpu);
  for (const double sign : {-1.0, 1.0}) {
    scene.AddSource(SourceCamera(camera, {0.5 * sign, 0.0, 0.0}, -0.15 * sign));
    scene.AddSource(SourceCamera(camera, {0.1, 0.4 * sign, 0.0}, 0.0));
  }
  return scene;
}

// From random planes to the plane of the scene.
PlaneHypotheses FindThePlane(TexturedPlane& scene,
                             bool with_depth,
                             Device& device) {
  PatchMatchOptions options;
  options.depth_min = 1.5f;
  options.depth_max = 6.f;
  const DeviceImage<float> gray(device, scene.Gray());
  std::vector<SourceView> sources = scene.Sources().ToHost();
  std::vector<DeviceImage<GrayPair>> grays;
  std::vector<DeviceImage<float>> depths;
  for (size_t i = 0; i < sources.size(); ++i) {
    grays.emplace_back(device, PairsOf(scene.SourceGray(static_cast<int>(i))));
    sources[i].gray = std::as_const(grays.back()).View();
    sources[i].depth = {};
    if (with_depth) {
      depths.emplace_back(device, scene.SourceDepth(static_cast<int>(i)));
      sources[i].depth = std::as_const(depths.back()).View();
    }
  }
  const Intrinsics intrinsics = scene.Reference().intrinsics;
  return RunPatchMatch(
      {{intrinsics, gray.View(), {}, {}},
       Buffer<SourceView>(device, sources),
       1},
      DrawPlanes(intrinsics, kWidth, kHeight, 1, options, device),
      options,
      device);
}

// The share of pixels whose depths are right to 0.5 %.
double ShareFound(const Image<float>& found, const Image<float>& truth) {
  size_t num_found = 0;
  for (size_t i = 0; i < truth.NumPixels(); ++i) {
    num_found +=
        std::abs(found.Data()[i] / truth.Data()[i] - 1.f) < 0.005f ? 1 : 0;
  }
  return static_cast<double>(num_found) /
         static_cast<double>(truth.NumPixels());
}

// One choice that rounding turns would lead a pixel, and those that take its
// plane over, along another way.
TEST_F(CudaTest, RunPatchMatchWithTexture) {
  TexturedPlane scene = DrawTexturedPlane(*cpu_);
  for (const bool with_depth : {false, true}) {
    const auto run = [&](Device& device) {
      const PlaneHypotheses found = FindThePlane(scene, with_depth, device);
      const DeviceImage<float> depth =
          MapsFromPlanes(
              scene.Reference().intrinsics, found.planes.View(), device)
              .depth;
      EXPECT_GT(ShareFound(depth.ToHost(), scene.Depth()), 0.9);
      StageResult result;
      result.Add("planes", found.planes);
      result.Add("costs", found.costs);
      result.Add("depth", depth);
      return result;
    };
    const StageResult on_cpu = run(*cpu_);
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(FindDifferences(on_cpu, run(*cuda_)), "")
          << (with_depth ? "with depths" : "without depths");
    }
  }
}

// Without texture no plane is better than another.
TEST_F(CudaTest, RunPatchMatchWithoutTexture) {
  ExpectAlike("RunPatchMatch without texture",
              {{SceneKind::kEqual, 1, 1},
               {SceneKind::kEqual, 1, 37},
               {SceneKind::kEqual, 97, 61},
               {SceneKind::kEqual, 1201, 37}},
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const ReferenceView reference = inputs.views.Reference();
                const PatchMatchOptions options = BoundsAroundTheWall();
                const PlaneHypotheses found = RunPatchMatch(
                    {reference, Sources(inputs, false, device), 1},
                    DrawPlanes(reference.intrinsics,
                               inputs.views.Width(),
                               inputs.views.Height(),
                               3,
                               options,
                               device),
                    options,
                    device);
                result->Add("planes", found.planes);
                result->Add("costs", found.costs);
              });
}

TEST_F(CudaTest, FilterHypotheses) {
  ExpectAlike("FilterHypotheses",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                HypothesisFilterOptions options;
                result->Add("filtered",
                            FilterHypotheses(inputs.views.Reference(),
                                             inputs.views.Sources(),
                                             {},
                                             options,
                                             device));
                options.window_radius = 8.f;
                options.min_num_consistent = 3;
                result->Add("strictly filtered",
                            FilterHypotheses(inputs.views.Reference(),
                                             inputs.views.Sources(),
                                             {},
                                             options,
                                             device));
              });
}

TEST_F(CudaTest, PairGray) {
  ExpectAlike("PairGray",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                result->Add("pairs",
                            PairGray(inputs.views.Reference().gray, device));
              });
}

TEST_F(CudaTest, PlanarPrior) {
  ExpectAlike(
      "FindReliableDepth, RunPatchMatch and FilterHypotheses with it",
      AllScenesAndWide(),
      [](StageInputs& inputs, Device& device, StageResult* result) {
        const ReferenceView reference = inputs.views.Reference();
        const Buffer<SourceView>& sources = inputs.views.Sources();
        const DeviceImage<float> reliable =
            FindReliableDepth(reference, sources, 5.f, device);
        result->Add("reliable depth", reliable);
        const DeviceImage<Plane> prior(
            device, TriangulatePlanes(reliable.ToHost(), reference.intrinsics));
        result->Add("prior", prior);
        PatchMatchOptions options = BoundsAroundTheWall();
        options.num_iterations = 1;
        // Every third pixel keeps its plane.
        Image<uint8_t> keeps(inputs.views.Width(), inputs.views.Height());
        for (size_t i = 0; i < keeps.NumPixels(); i += 3) {
          keeps.Data()[i] = 1;
        }
        const DeviceImage<uint8_t> keeps_plane(device, keeps);
        PatchMatchInputs search{reference, sources, 1};
        search.prior = prior.View();
        search.keeps_plane = keeps_plane.View();
        const PlaneHypotheses found = RunPatchMatch(
            search, PlanesOfTheMaps(inputs, device), options, device);
        result->Add("planes", found.planes);
        result->Add("costs", found.costs);
        result->Add(
            "filtered",
            FilterHypotheses(reference, sources, prior.View(), {}, device));
      });
}

TEST_F(CudaTest, SmoothNormals) {
  ExpectAlike("SmoothNormals",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const DepthNormalViews maps = inputs.views.Hypotheses();
                result->Add("normal",
                            SmoothNormals(inputs.views.MapIntrinsics(),
                                          maps.depth,
                                          maps.normal,
                                          {},
                                          device));
              });
}

}  // namespace
}  // namespace tsar
