// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/export/export_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/input_folders.h"
#include "colmap_tsar/run/store/json_file.h"
#include "colmap_tsar/run/store/output_folder.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/export/image_exporter.h"
#include "colmap_tsar/tools/export/scene_files.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

using Json = nlohmann::ordered_json;

Json Conventions() {
  Json json;
  json["units"] = "lengths are in units of the sparse model";
  json["camera_frame"] = "x right, y down, z forward";
  json["poses"] =
      "4 x 4, row by row: world_to_camera takes points of the sparse model to "
      "the camera's frame";
  json["pixels"] =
      "column x and row y count from 0; depth z there is the point z * ((x - "
      "cx) / fx, (y - cy) / fy, 1) of the camera's frame, as for stereo_fusion";
  json["half_pixel"] =
      "cx and cy are the sparse model's, scaled: in it (0.5, 0.5) is the "
      "center of the top left pixel; what is projected for the photos, as by "
      "trainers, takes x + 0.5 and y + 0.5";
  json["values"] = "scale * stored + offset";
  return json;
}

Json ImageJson(const Workspace& workspace,
               int image,
               const ExportedImage& exported) {
  const SparseModel::ModelImage& model_image =
      workspace.Model().images.at(image);
  Json json;
  json["name"] = model_image.name;
  json["camera"] = IntrinsicsJson(
      model_image.camera.Resized(exported.width, exported.height));
  json["world_to_camera"] = MatrixJson(WorldToCamera(model_image.camera));
  json["camera_to_world"] = MatrixJson(CameraToWorld(model_image.camera));
  json["refined"] = Exists(workspace.Paths(image, workspace.Type()).provenance);
  json["num_depths"] = exported.depth.num_depths;
  json["num_out_of_range"] = exported.num_out_of_range;
  json["files"] = exported.files;
  return json;
}

// The content of an export's manifest.json (docs/export.md): conventions, the
// description of maps, and each image with its camera at the size of its maps,
// pose, files.
Json MakeExportManifest(const Workspace& workspace,
                        ExportFormat format,
                        const Json& maps,
                        const std::vector<int>& images,
                        const std::vector<ExportedImage>& exported) {
  Json json;
  json["format"] = "tsar_export";
  json["version"] = 1;
  json["program"] = std::string("colmap_tsar ") + TSAR_VERSION;
  json["export_format"] = ToString(format);
  json["map_type"] = ToString(workspace.Type());
  json["conventions"] = Conventions();
  json["maps"] = maps;
  json["images"] = Json::array();
  for (size_t i = 0; i < images.size(); ++i) {
    json["images"].push_back(ImageJson(workspace, images[i], exported[i]));
  }
  json["images_left_out"] = Json::array();
  const int num_images = static_cast<int>(workspace.Model().images.size());
  for (int image = 0; image < num_images; ++image) {
    if (!std::ranges::binary_search(images, image)) {
      json["images_left_out"].push_back(workspace.Model().images[image].name);
    }
  }
  return json;
}

constexpr OutputFolderKind kExportFolder = {"export",
                                            "an export",
                                            "tsar_export",
                                            "output_path",
                                            "manifest.json",
                                            "files.txt",
                                            "unfinished_export"};

// The loop over images, with progress and interruption.
class ExportLoop {
 public:
  ExportLoop(const Workspace& workspace,
             int num_threads,
             Progress& progress,
             const std::function<bool()>& should_stop)
      : workspace_(workspace),
        num_threads_(num_threads),
        progress_(progress),
        should_stop_(should_stop) {}

  // Returns the results of function(image), in the order of the images.
  template <typename Result>
  std::vector<Result> Run(const std::vector<int>& images,
                          const std::string& pass,
                          const std::function<Result(int)>& function) const {
    std::vector<Result> results(images.size());
    progress_.Start(static_cast<int>(images.size()), pass);
    ForEachImage(workspace_, images, num_threads_, [&](size_t i) {
      if (should_stop_()) {
        throw Error(ErrorCode::kInterrupted,
                    "interrupted; nothing was exported");
      }
      results[i] = function(images[i]);
      progress_.Advance(true);
    });
    progress_.Finish();
    return results;
  }

 private:
  const Workspace& workspace_;
  int num_threads_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
};

void Check(const ExportOptions& options) {
  if (options.format != ExportFormat::kPng16 &&
      options.depth_scale != ExportOptions::kDefaultDepthScale) {
    throw Error(ErrorCode::kBadOption,
                OptionName("depth_scale") + " is for " + OptionName("format") +
                    " png16 alone; leave it out, or give that format");
  }
  if (options.format != ExportFormat::kNerfstudio &&
      !options.cloud_path.empty()) {
    throw Error(ErrorCode::kBadOption,
                OptionName("cloud_path") + " is for " + OptionName("format") +
                    " nerfstudio alone; leave it out, or give that format");
  }
}

// Whether the format holds images without maps, too.
bool HoldsAllImages(ExportFormat format) {
  return format == ExportFormat::kNerfstudio ||
         format == ExportFormat::kGaussianSplatting;
}

DepthStatistics MeasureAll(const Workspace& workspace,
                           const std::vector<int>& images,
                           const ExportLoop& loop) {
  const DepthStatistics depth = JoinStatistics(
      loop.Run<DepthStatistics>(images, "Export, pass 1 of 2:", [&](int image) {
        return MeasureDepth(ReadImageDepth(workspace, image));
      }));
  if (depth.num_depths == 0) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.Root().string(),
        "no pixel of its " + ToString(workspace.Type()) + " maps has a depth",
        "run patch_match_stereo on it again");
  }
  return depth;
}

std::unique_ptr<ImageExporter> MakeExporter(const Workspace& workspace,
                                            const ExportOptions& options,
                                            const std::vector<int>& with_maps,
                                            const ContainedPath& folder,
                                            const ExportLoop& loop) {
  switch (options.format) {
    case ExportFormat::kNerfstudio:
      return MakeNerfstudioExporter(workspace, folder, options.cloud_path);
    case ExportFormat::kGaussianSplatting:
      return MakeGaussianSplattingExporter(
          workspace, folder, MeasureAll(workspace, with_maps, loop));
    default:
      return MakeMapExporter(
          workspace, folder, options.format, options.depth_scale);
  }
}

ExportSummary Summarize(const std::vector<ExportedImage>& exported) {
  ExportSummary summary;
  for (const ExportedImage& image : exported) {
    ++summary.num_images;
    summary.num_with_depth += image.depth.num_depths > 0 ? 1 : 0;
    summary.num_pixels += static_cast<int64_t>(image.width) * image.height;
    summary.num_depths += image.depth.num_depths;
  }
  return summary;
}

}  // namespace

ExportSummary ExportWorkspace(Workspace workspace,
                              const ExportOptions& options,
                              Progress& progress,
                              const std::function<bool()>& should_stop) {
  Check(options);
  workspace.UseMasks(options.mask_path);
  RequireOutsideInputs(
      workspace.Root(), options.output_path, OptionName("output_path"));
  // The lock keeps the maps of an image consistent.
  const WorkspaceLock lock(workspace.Root(), WorkspaceLock::Mode::kShared);
  const std::vector<int> with_maps = FindImagesWithMaps(workspace);
  if (with_maps.empty()) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.Root().string(),
        "no image has " + ToString(workspace.Type()) + " depth and normal maps",
        "run patch_match_stereo or tsar_stereo on it first");
  }
  if (!HoldsAllImages(options.format)) {
    WarnOfChangedResults(workspace);
  }
  std::vector<int> images = with_maps;
  if (HoldsAllImages(options.format)) {
    images.resize(workspace.Model().images.size());
    std::iota(images.begin(), images.end(), 0);
  }
  OutputFolder folder(kExportFolder, options.output_path, options.overwrite);
  const ContainedPath root(folder.Temporary(), {});
  const ExportLoop loop(workspace, options.num_threads, progress, should_stop);
  const std::unique_ptr<ImageExporter> exporter =
      MakeExporter(workspace, options, with_maps, root, loop);
  const std::vector<ExportedImage> exported = loop.Run<ExportedImage>(
      images,
      options.format == ExportFormat::kGaussianSplatting
          ? "Export, pass 2 of 2:"
          : "Export:",
      [&](int image) { return exporter->Export(image); });
  exporter->Finish(images, exported);
  WriteOrderedJson(root / kExportFolder.known_file,
                   MakeExportManifest(workspace,
                                      options.format,
                                      exporter->DescribeMaps(),
                                      images,
                                      exported));
  folder.Commit();
  ExportSummary summary = Summarize(exported);
  summary.num_masks = workspace.CountMasks(images);
  return summary;
}

}  // namespace tsar
