// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/evaluation/depth_evaluation.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/opencv_threads.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/resize_nearest.h"
#include "colmap_tsar/fusion/fuse_images.h"
#include "colmap_tsar/fusion/fusion_neighbors.h"
#include "colmap_tsar/fusion/fusion_options.h"
#include "colmap_tsar/io/image_masks.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/io/photo.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/evaluation/tolerances.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr int kTextureWindow = 11;
constexpr float kMaxGrayVariance = 16.f;

fs::path GroundTruthFolder(const fs::path& workspace_path,
                           const fs::path& given) {
  return given.empty() ? workspace_path / "ground_truth" / "depth" : given;
}

// The names of all images that have ground truth.
std::set<std::string> ListGroundTruth(const fs::path& folder) {
  std::set<std::string> names = ListFileNames({folder, {}}, ".bin");
  if (names.empty()) {
    throw Error::File(
        ErrorCode::kNotFound,
        folder.string(),
        "there are no ground truth depth maps (NAME.bin)",
        "give their folder as " + OptionName("ground_truth_path"));
  }
  return names;
}

// The mask of textureless pixels (not 0) of the image at this path, resized.
Image<uint8_t> FindTextureless(const fs::path& path,
                               Image<uint8_t> photo,
                               const RasterSize& size) {
  RequireShape(path,
               {photo.Width(), photo.Height()},
               size,
               "its ground truth",
               "give ground truth of this image");
  const cv::Mat gray(photo.Height(), photo.Width(), CV_8UC1, photo.Data());
  cv::Mat resized;
  cv::resize(gray, resized, {size.width, size.height}, 0, 0, cv::INTER_AREA);
  resized.convertTo(resized, CV_32F);
  const cv::Size window(kTextureWindow, kTextureWindow);
  cv::Mat mean;
  cv::Mat mean_square;
  cv::blur(resized, mean, window);
  cv::blur(resized.mul(resized), mean_square, window);
  Image<uint8_t> textureless(size.width, size.height);
  cv::Mat(size.height, size.width, CV_8UC1, textureless.Data()) =
      mean_square - mean.mul(mean) < kMaxGrayVariance;
  return textureless;
}

// Adds one image's pixels to the score of its area. mask: of the estimate, or
// empty. textureless: of the ground truth.
void AddPixels(const Image<float>& estimate,
               const Image<float>& truth,
               const Image<uint8_t>& mask,
               const Image<uint8_t>& textureless,
               DepthScore* score) {
  const bool is_of_all = score->area == "all";
  const float tolerance = static_cast<float>(score->tolerance);
  for (int y = 0; y < estimate.Height(); ++y) {
    const int truth_y = NearestPixel(y, truth.Height(), estimate.Height());
    for (int x = 0; x < estimate.Width(); ++x) {
      const int truth_x = NearestPixel(x, truth.Width(), estimate.Width());
      const float known = truth(truth_x, truth_y);
      if (known <= 0 || !(is_of_all || textureless(truth_x, truth_y) != 0) ||
          (!mask.Empty() && mask(x, y) != 0)) {
        continue;
      }
      const float depth = estimate(x, y);
      ++score->num_known;
      score->num_estimated += depth > 0;
      score->num_right += depth > 0 && std::abs(depth - known) < tolerance;
    }
  }
}

Image<float> ReadTruth(const fs::path& path) {
  Image<float> truth = ReadDepthMap(path);
  if (*std::ranges::max_element(truth) <= 0.f) {
    throw Error::File(ErrorCode::kCorrupt,
                      path.string(),
                      "is no ground truth: none of its depths is above 0",
                      "give ground truth of this image, or remove the file");
  }
  return truth;
}

// Adds one image to the scores. mask_path: empty without a mask.
void ScoreImage(const fs::path& photo_path,
                const fs::path& map_path,
                const fs::path& truth_path,
                const fs::path& mask_path,
                DepthEvaluation* evaluation) {
  ++evaluation->num_images;
  const Image<float> estimate = ReadDepthMap(map_path);
  const Image<float> truth = ReadTruth(truth_path);
  const RasterSize size{estimate.Width(), estimate.Height()};
  const RasterSize truth_size{truth.Width(), truth.Height()};
  RequireShape(map_path,
               size,
               truth_size,
               "its ground truth",
               "give ground truth of this image");
  Image<uint8_t> photo = ReadGrayPhoto(photo_path);
  const RasterSize photo_size{photo.Width(), photo.Height()};
  const Image<uint8_t> textureless =
      FindTextureless(photo_path, std::move(photo), truth_size);
  Image<uint8_t> mask;
  if (!mask_path.empty()) {
    mask = ResizeMask(ReadImageMask(mask_path, {photo_size, size}), size);
    ++*evaluation->num_masks;
  }
  for (DepthScore& score : evaluation->scores) {
    AddPixels(estimate, truth, mask, textureless, &score);
  }
}

// The masks of all images by their names; it is no error if only those without
// ground truth have some.
std::map<std::string, fs::path> FindMasks(const fs::path& folder,
                                          const fs::path& images,
                                          std::set<std::string> names) {
  RequireNoImageFolder(folder, images, "masks", OptionName("mask_path"));
  names.merge(ListFileNames({images, {}}, ""));
  const std::vector<std::string> list(names.begin(), names.end());
  const std::vector<fs::path> found =
      FindImageMasks(folder, list, OptionName("mask_path"));
  std::map<std::string, fs::path> masks;
  for (size_t i = 0; i < list.size(); ++i) {
    masks[list[i]] = found[i];
  }
  return masks;
}

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
std::vector<fs::path> FindTruths(const Workspace& workspace,
                                 const FusionPlan& plan,
                                 const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const int image : plan.order) {
    const fs::path path =
        folder / (workspace.Model().images[image].name + ".bin");
    paths.push_back(Exists(path) ? path : "");
  }
  if (std::ranges::all_of(paths, &fs::path::empty)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "there is no ground truth (NAME.bin) of an image that "
                      "is fused",
                      "give its folder as " + OptionName("ground_truth_path"));
  }
  return paths;
}

Image<float> ReadTruthOf(const Image<FusionPixel>& pixels,
                         const fs::path& path) {
  Image<float> truth = ReadTruth(path);
  RequireShape(path,
               {truth.Width(), truth.Height()},
               {pixels.Width(), pixels.Height()},
               "the depth map",
               "give ground truth of this image");
  return truth;
}

}  // namespace

double DepthScore::Precision() const {
  return static_cast<double>(num_right) / std::max<int64_t>(num_estimated, 1);
}

double DepthScore::Recall() const {
  return static_cast<double>(num_right) / std::max<int64_t>(num_known, 1);
}

double DepthScore::F1() const { return HarmonicMean(Precision(), Recall()); }

DepthEvaluation EvaluateDepthMaps(const fs::path& workspace_path,
                                  const DepthEvaluationOptions& options) {
  CheckTolerances(options.tolerances);
  const OpenCvWithoutThreads opencv_without_threads;
  const fs::path truth_folder =
      GroundTruthFolder(workspace_path, options.ground_truth_path);
  const std::string input_type = ToString(options.input_type);
  const fs::path map_folder = workspace_path / "stereo" / "depth_maps";

  // Depth maps alone can be scored, too.
  if (Exists(GetTsarFolder(workspace_path)) &&
      Exists(workspace_path / "sparse")) {
    WarnOfChangedResults(Workspace(workspace_path, options.input_type),
                         {"depth"});
  }
  DepthEvaluation evaluation;
  for (const char* area : {"all", "textureless"}) {
    for (const double tolerance : options.tolerances) {
      evaluation.scores.push_back({area, tolerance});
    }
  }
  const std::set<std::string> names = ListGroundTruth(truth_folder);
  std::map<std::string, fs::path> masks;
  if (!options.mask_path.empty()) {
    masks = FindMasks(options.mask_path, workspace_path / "images", names);
    evaluation.num_masks = 0;
  }
  for (const std::string& name : names) {
    const fs::path map_path = map_folder / (name + "." + input_type + ".bin");
    if (!Exists(map_path)) {
      ++evaluation.num_images_without_map;
      continue;
    }
    ScoreImage(workspace_path / "images" / name,
               map_path,
               truth_folder / (name + ".bin"),
               masks[name],
               &evaluation);
  }
  if (evaluation.num_images == 0) {
    throw Error::File(ErrorCode::kNotFound,
                      map_folder.string(),
                      "there is no " + input_type +
                          " depth map of an image with ground truth",
                      "check " + OptionName("workspace_path") + ", or " +
                          AdviceOfTypes(workspace_path));
  }
  return evaluation;
}

FusedPixelEvaluation EvaluateFusedPixels(const Workspace& workspace,
                                         const DepthEvaluationOptions& options,
                                         const FusionOptions& fusion,
                                         const DeviceOptions& devices,
                                         Progress& progress) {
  CheckTolerances(options.tolerances);
  const WorkspaceLock lock(workspace.Root(), WorkspaceLock::Mode::kShared);
  WarnOfChangedResults(workspace);
  const FusionPlan plan = PlanFusion(workspace, {}, fusion.check_num_images);
  WarnOfConventions(workspace, plan.order);
  const std::vector<fs::path> truths = FindTruths(
      workspace,
      plan,
      GroundTruthFolder(workspace.Root(), options.ground_truth_path));
  std::vector<FusedPixelEvaluation> of_images(plan.order.size());
  FuseImages(
      workspace,
      plan,
      fusion,
      devices,
      [&](size_t place, const FusedImage& fused) {
        if (!truths[place].empty()) {
          of_images[place] =
              EvaluateImage(fused,
                            ReadTruthOf(fused.view->pixels, truths[place]),
                            options.tolerances);
        }
      },
      progress);
  FusedPixelEvaluation sum;
  sum.num_right.assign(options.tolerances.size(), 0);
  for (const FusedPixelEvaluation& image : of_images) {
    Add(image, &sum);
  }
  return sum;
}

}  // namespace tsar
