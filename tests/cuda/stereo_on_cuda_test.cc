// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/matching/filter_hypotheses.h"
#include "colmap_tsar/matching/patch_match.h"
#include "colmap_tsar/matching/smooth_normals.h"

#include "tests/cuda/cuda_test.h"

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
        result->Add("drawn", {1e-4, 1e-5, 1e-3}, drawn);
        const DeviceImage<Plane> planes = PlanesOfTheMaps(inputs, device);
        result->Add("planes", kCloseDepths, planes);
        result->Add(
            "resized",
            kCloseDepths,
            ResizePlanes(
                planes.View(), (width + 1) / 2, 2 * height + 1, device));
        const PlaneMaps maps =
            MapsFromPlanes(intrinsics, planes.View(), device);
        result->Add("depth", kCloseDepths, maps.depth);
        result->Add("normal", kCloseDepths, maps.normal);
      });
}

// A choice that rounding turns leads a pixel, and those that take its plane
// over, along another way to the same surface. So pixels may differ, but nearly
// all of them by less than what their image tells of depth.
TEST_F(CudaTest, RunPatchMatch) {
  for (const bool with_depth : {false, true}) {
    ExpectAlike(
        with_depth ? "RunPatchMatch with depths" : "RunPatchMatch",
        {{SceneKind::kWall, 97, 61}, {SceneKind::kWall, 1201, 37}},
        [&](StageInputs& inputs, Device& device, StageResult* result) {
          ReferenceView reference = inputs.views.Reference();
          const PatchMatchOptions options = BoundsAroundTheWall();
          const PlaneHypotheses found =
              RunPatchMatch({reference, Sources(inputs, with_depth, device), 1},
                            PlanesOfTheMaps(inputs, device),
                            options,
                            device);
          result->Add(
              "depth",
              {2e-3, 0.0, 0.02},
              MapsFromPlanes(reference.intrinsics, found.planes.View(), device)
                  .depth);
          result->Add("costs", {0.0, 0.01, 0.01}, found.costs);
        });
  }
}

// Without texture no plane is better than another, and none may win by
// rounding.
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
                result->Add("planes", {1e-4, 1e-5, 1e-3}, found.planes);
                result->Add("costs", kCloseScores, found.costs);
              });
}

TEST_F(CudaTest, FilterHypotheses) {
  ExpectAlike("FilterHypotheses",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                HypothesisFilterOptions options;
                result->Add("filtered",
                            kCloseDepths,
                            FilterHypotheses(inputs.views.Reference(),
                                             inputs.views.Sources(),
                                             options,
                                             device));
                options.window_radius = 8.f;
                options.min_num_consistent = 3;
                result->Add("strictly filtered",
                            kCloseDepths,
                            FilterHypotheses(inputs.views.Reference(),
                                             inputs.views.Sources(),
                                             options,
                                             device));
              });
}

TEST_F(CudaTest, SmoothNormals) {
  ExpectAlike("SmoothNormals",
              AllScenesAndWide(),
              [](StageInputs& inputs, Device& device, StageResult* result) {
                const DepthNormalViews maps = inputs.views.Hypotheses();
                result->Add("normal",
                            kCloseScores,
                            SmoothNormals(inputs.views.MapIntrinsics(),
                                          maps.depth,
                                          maps.normal,
                                          {},
                                          device));
              });
}

}  // namespace
}  // namespace tsar
