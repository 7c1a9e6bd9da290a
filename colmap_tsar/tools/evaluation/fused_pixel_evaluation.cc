// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/fused_pixel_evaluation.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/fusion/fusion_neighbors.h"
#include "colmap_tsar/fusion/fusion_run.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/evaluation/depth_evaluation.h"
#include "colmap_tsar/tools/evaluation/tolerances.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace tsar {
namespace {

FusedPixelEvaluation EvaluateImage(const FusedImage& fused,
                                   const Image<float>& truth,
                                   const std::vector<double>& tolerances) {
  FusedPixelEvaluation evaluation;
  evaluation.num_images = 1;
  const auto truth_at = [&](int x, int y) {
    const Image<FusionPixel>& pixels = fused.view->pixels;
    return truth(NearestPixel(x, truth.Width(), pixels.Width()),
                 NearestPixel(y, truth.Height(), pixels.Height()));
  };
  for (int y = 0; y < fused.view->pixels.Height(); ++y) {
    for (int x = 0; x < fused.view->pixels.Width(); ++x) {
      evaluation.num_known += truth_at(x, y) > 0.f ? 1 : 0;
    }
  }
  evaluation.num_right.assign(tolerances.size(), 0);
  for (const FusedPoint& point : fused.points) {
    const float known = truth_at(point.column, point.row);
    if (!(known > 0.f)) {
      continue;
    }
    ++evaluation.num_fused;
    const float depth = fused.view->pixels(point.column, point.row).depth;
    const float error = std::abs(depth - known);
    for (size_t t = 0; t < tolerances.size(); ++t) {
      evaluation.num_right[t] +=
          error < static_cast<float>(tolerances[t]) ? 1 : 0;
    }
  }
  return evaluation;
}

void Add(const FusedPixelEvaluation& image, FusedPixelEvaluation* sum) {
  sum->num_images += image.num_images;
  sum->num_known += image.num_known;
  sum->num_fused += image.num_fused;
  for (size_t t = 0; t < image.num_right.size(); ++t) {
    sum->num_right[t] += image.num_right[t];
  }
}

// The ground truth of each fused image; empty where there is none. Throws Error
// kNotFound where no image has ground truth.
std::vector<std::filesystem::path> FindTruths(
    const Workspace& workspace,
    const FusionPlan& plan,
    const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const int image : plan.order) {
    const std::filesystem::path path =
        folder / (workspace.Model().images[image].name + ".bin");
    paths.push_back(Exists(path) ? path : "");
  }
  if (std::ranges::all_of(paths, &std::filesystem::path::empty)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "there is no ground truth (NAME.bin) of an image that "
                      "is fused",
                      "give its folder as " + OptionName("ground_truth_path"));
  }
  return paths;
}

Image<float> ReadTruth(const std::filesystem::path& path,
                       const Image<FusionPixel>& pixels) {
  Image<float> truth = ReadDepthMap(path);
  RequireShape(path,
               {truth.Width(), truth.Height()},
               {pixels.Width(), pixels.Height()},
               "the depth map",
               "give ground truth of this image");
  return truth;
}

}  // namespace

FusedPixelEvaluation EvaluateFusedPixels(
    const Workspace& workspace,
    const FusedPixelOptions& options,
    Progress& progress,
    const std::function<bool()>& should_stop) {
  CheckTolerances(options.tolerances);
  options.fusion.Check();
  if (options.fusion.point_spacing != 1) {
    throw Error(ErrorCode::kBadOption,
                OptionName("point_spacing") + " has to be 1 here");
  }
  const WorkspaceLock lock(workspace.Root(), WorkspaceLock::Mode::kShared);
  const FusionPlan plan =
      PlanFusion(workspace, {}, options.fusion.check_num_images);
  const std::vector<std::filesystem::path> truths = FindTruths(
      workspace,
      plan,
      GroundTruthFolder(workspace.Root(), options.ground_truth_path));
  FusionRun run(workspace, plan, options.fusion, options.devices);
  std::vector<FusedPixelEvaluation> of_images(plan.order.size());
  FusedPixelEvaluation sum;
  sum.num_right.assign(options.tolerances.size(), 0);
  run.Run(
      [&](size_t place, const FusedImage& fused) {
        if (!truths[place].empty()) {
          of_images[place] =
              EvaluateImage(fused,
                            ReadTruth(truths[place], fused.view->pixels),
                            options.tolerances);
        }
      },
      [&](size_t place) { Add(of_images[place], &sum); },
      progress,
      should_stop);
  return sum;
}

}  // namespace tsar
