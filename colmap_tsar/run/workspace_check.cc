// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/workspace_check.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/io/photo.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/scene_model_file.h"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>

namespace tsar {
namespace {

// Returns the number of pixels.
int64_t RequirePossibleSize(const std::filesystem::path& path,
                            int width,
                            int height,
                            const char* advice) {
  // The limit of OpenCV; pixels are also indexed by an int.
  constexpr int64_t kMaxNumPixels = int64_t{1} << 30;
  const int64_t num_pixels = int64_t{width} * height;
  if (num_pixels > kMaxNumPixels) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "has " + ToString(RasterSize{width, height}) +
                          " pixels, more than the 2^30 that can be worked on",
                      advice);
  }
  return num_pixels;
}

// The size of an image's original maps, or nothing where there are none.
std::optional<RasterSize> CheckMaps(const Workspace& workspace,
                                    int image,
                                    ImageRemarks* remarks) {
  const MapType type = workspace.Type();
  const MapPaths paths = workspace.Paths(image, type);
  RequireNoStrayResults(paths);
  const OriginalMaps originals = FindOriginals(paths);
  const bool has_depth = !originals.depth.path.empty();
  const bool has_normal = !originals.normal.path.empty();
  if (has_depth != has_normal) {
    throw Error::File(
        ErrorCode::kNotFound,
        (has_depth ? paths.normal : paths.depth).string(),
        has_depth ? "there is a depth map of this name, but no normal map"
                  : "there is a normal map of this name, but no depth map",
        AdviceForMissing(has_depth ? paths.normal : paths.depth,
                         "run patch_match_stereo again for this image"));
  }
  if (!has_depth) {
    return std::nullopt;
  }
  const DepthNormalReader maps = workspace.OpenOriginalMaps(image, type);
  remarks->Add(maps.conventions.remarks,
               workspace.Name(image) + ", " + ToString(type) + " maps");
  return maps.Size();
}

// Checks that the files of an image can be written, before hours of work.
void CheckTargets(const MapPaths& paths) {
  RequireNoFolder(paths.depth.Path());
  RequireNoFolder(paths.normal.Path());
  for (const ResultFile& result : ResultFiles(paths)) {
    RequireNoFolder(result.path->Path());
  }
}

// What the check of an image's files has found.
struct ImageCheck {
  bool has_maps = false;  // To refine.
  bool has_prior = false;
  int64_t num_pixels = 0;
  int64_t num_image_pixels = 0;
  ImageRemarks remarks;
};

ImageCheck CheckImage(const Workspace& workspace, int image) {
  ImageCheck check;
  const MapType type = workspace.Type();
  const std::optional<RasterSize> size =
      CheckMaps(workspace, image, &check.remarks);
  if (!size) {
    return check;
  }
  check.has_maps = true;
  CheckTargets(workspace.Paths(image, type));
  CheckPhotoFile(workspace.ImagePath(image));
  workspace.CheckMask(image, *size);
  const std::shared_ptr<DepthPrior> prior = workspace.ReadPrior(image);
  if (prior != nullptr && prior->no_depth != 0.f) {
    check.remarks.Add({NoDepthRemark(prior->no_depth)},
                      workspace.Priors().FilesOf(image).depth.string());
  }
  check.has_prior = prior != nullptr;
  workspace.OpenCosts(image, *size);
  const Camera& camera = workspace.CameraOf(image);
  check.num_pixels =
      RequirePossibleSize(workspace.Paths(image, type).depth,
                          size->width,
                          size->height,
                          "run patch_match_stereo with a smaller "
                          "--PatchMatchStereo.max_image_size");
  check.num_image_pixels =
      RequirePossibleSize(workspace.ImagePath(image),
                          camera.width,
                          camera.height,
                          "run image_undistorter with a smaller "
                          "--max_image_size");
  return check;
}

Error NoMaps(const Workspace& workspace) {
  const std::filesystem::path root = workspace.Root();
  if (workspace.Problems().empty()) {
    return Error::File(ErrorCode::kNotFound,
                       (root / "stereo" / "patch-match.cfg").string(),
                       "names no image",
                       "make the workspace again with image_undistorter");
  }
  return Error::File(
      ErrorCode::kNotFound,
      (root / "stereo" / "depth_maps").string(),
      "holds no " + ToString(workspace.Type()) +
          " map of an image in patch-match.cfg",
      AdviceForMissing(
          workspace
              .Paths(workspace.Problems().front().reference, workspace.Type())
              .depth,
          "run patch_match_stereo first, or " + AdviceOfTypes(root)));
}

// Whether an image of patch-match.cfg has a depth or a normal map of this type.
bool HasAnyMap(const Workspace& workspace, MapType type) {
  return std::ranges::any_of(
      workspace.Problems(), [&](const StereoProblem& problem) {
        const MapPaths paths = workspace.Paths(problem.reference, type);
        return Exists(paths.depth) || Exists(paths.normal) ||
               Exists(paths.original_depth) || Exists(paths.original_normal);
      });
}

Workspace OpenMapsOf(const WorkspaceRefineOptions& options) {
  Workspace workspace(options.workspace_path,
                      options.input_type.value_or(MapType::kGeometric));
  if (!options.input_type && !HasAnyMap(workspace, MapType::kGeometric) &&
      HasAnyMap(workspace, MapType::kPhotometric)) {
    Warn(options.workspace_path.string() +
         ": there are no geometric maps; refining the photometric ones");
    return Workspace(options.workspace_path, MapType::kPhotometric);
  }
  return workspace;
}

}  // namespace

WorkspaceOverview CheckWorkspace(const Workspace& workspace, int num_threads) {
  const std::set<int> in_use = workspace.ImagesInUse();
  const std::vector<int> images(in_use.begin(), in_use.end());
  RequireNoFolder(GetSceneModelPath(workspace.Root()).Path());
  WorkspaceOverview overview;
  overview.has_maps.resize(workspace.Model().images.size());
  std::vector<ImageCheck> checks(images.size());
  ForEachImage(workspace, images, num_threads, [&](size_t i) {
    checks[i] = CheckImage(workspace, images[i]);
  });
  ImageRemarks remarks;
  for (size_t i = 0; i < images.size(); ++i) {
    const ImageCheck& check = checks[i];
    overview.has_maps[images[i]] = check.has_maps;
    overview.has_priors |= check.has_prior;
    overview.max_num_pixels =
        std::max(overview.max_num_pixels, check.num_pixels);
    overview.max_num_image_pixels =
        std::max(overview.max_num_image_pixels, check.num_image_pixels);
    remarks.Add(check.remarks);
  }
  std::ranges::for_each(remarks.Lines(), &Warn);
  bool any_reference = false;
  for (const StereoProblem& problem : workspace.Problems()) {
    if (!overview.has_maps[problem.reference]) {
      continue;
    }
    any_reference = true;
    const auto num_sources = std::ranges::count_if(
        problem.sources, [&](int source) { return overview.has_maps[source]; });
    overview.max_num_sources =
        std::max(overview.max_num_sources, static_cast<int>(num_sources));
  }
  if (!any_reference) {
    throw NoMaps(workspace);
  }
  return overview;
}

Workspace OpenWorkspace(const WorkspaceRefineOptions& options) {
  Workspace workspace = OpenMapsOf(options);
  workspace.UseMasks(options.mask_path);
  workspace.UsePriors(options.prior_path, options.prior_type);
  workspace.WarnOfStrayFiles();
  return workspace;
}

}  // namespace tsar
