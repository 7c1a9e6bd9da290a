// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/run/store/input_folders.h"
#include "colmap_tsar/run/store/json_file.h"
#include "colmap_tsar/run/store/output_folder.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/import/filter_maps.h"
#include "colmap_tsar/tools/import/target_workspace.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

constexpr OutputFolderKind kImportFolder = {"import",
                                            "an import",
                                            "tsar_import",
                                            "output_path",
                                            "stereo/tsar_import.json",
                                            "stereo/tsar_import_files.txt",
                                            "unfinished_import"};

std::string Text(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

int64_t CountDepths(const Image<float>& depth) {
  return std::ranges::count_if(depth, [](float value) { return value > 0.f; });
}

// Whether normals are in the world frame: in the right one, all face the camera
// or all face away from it.
bool AreInWorld(const NormalFacing& facing, ExternalFormat format) {
  const auto agreement = [&](int64_t num_facing) {
    return std::max(num_facing, facing.num_normals - num_facing);
  };
  const int64_t camera = agreement(facing.num_facing_in_camera);
  const int64_t world = agreement(facing.num_facing_in_world);
  // Where the frames are nearly the same, that of the format's documents.
  constexpr int64_t kMinPercent = 5;
  if (std::abs(world - camera) * 100 >= kMinPercent * facing.num_normals &&
      facing.num_normals > 0) {
    return world > camera;
  }
  return format == ExternalFormat::kAcm || format == ExternalFormat::kApd;
}

class Importer {
 public:
  Importer(const ImportOptions& options,
           Progress& progress,
           const std::function<bool()>& should_stop)
      : options_(options),
        progress_(progress),
        should_stop_(should_stop),
        model_(ReadTargetModel(options.workspace_path)),
        matched_(MatchImages(options.match, model_)) {
    summary_.output_path = options.output_path;
    summary_.type = options.match.type;
    summary_.num_images = static_cast<int>(model_.images.size());
    summary_.num_imported = static_cast<int>(matched_.files.size());
    summary_.num_without_image = matched_.num_without_image;
  }

  ImportSummary Run() {
    RequireOutsideInputs(options_.workspace_path,
                         options_.output_path,
                         OptionName("output_path"));
    OutputFolder folder(
        kImportFolder, options_.output_path, options_.overwrite);
    const ContainedPath root(folder.Temporary(), {});
    CheckFiles();
    CheckCameras(cameras_,
                 model_,
                 options_.depth_scale > 0.0 ? options_.depth_scale : 1.0);
    DecideScales();
    WriteInputs(options_.workspace_path, model_, root);
    // The filter reads maps of the one type and writes those of the other.
    WriteMaps(folder.Temporary(),
              MustFilter() ? MapType::kPhotometric : options_.match.type);
    if (MustFilter()) {
      Filter(folder.Temporary());
    }
    WriteJson(root / kImportFolder.known_file,
              {{"program", "colmap_tsar " TSAR_VERSION},
               {"workspace", options_.workspace_path.string()},
               {"maps", options_.match.input_path.string()}});
    folder.Commit();
    return std::move(summary_);
  }

 private:
  bool MustFilter() const {
    return options_.match.type == MapType::kGeometric &&
           (options_.match.format == ExternalFormat::kAcm ||
            options_.match.format == ExternalFormat::kApd);
  }

  void ThrowIfStopped() const {
    if (should_stop_ && should_stop_()) {
      throw Error(ErrorCode::kInterrupted, "interrupted; nothing was imported");
    }
  }

  const std::string& NameOf(const ExternalFiles& files) const {
    return model_.images[files.image].name;
  }

  const Camera& CameraOf(const ExternalFiles& files) const {
    return model_.images[files.image].camera;
  }

  double BaseScale(bool is_integer) const {
    constexpr double kMillimeter = 0.001;
    return options_.depth_scale > 0.0 ? options_.depth_scale
           : is_integer               ? kMillimeter
                                      : 1.0;
  }

  // Reads all files once and keeps the data for the checks.
  void CheckFiles() {
    progress_.Start(static_cast<int>(matched_.files.size()), "Checking:");
    for (const ExternalFiles& files : matched_.files) {
      ThrowIfStopped();
      const ExternalMaps external =
          ReadExternalMaps(files, options_.match.format);
      RequireShape(files.depth,
                   {external.depth.Width(), external.depth.Height()},
                   {CameraOf(files).width, CameraOf(files).height},
                   "the image " + NameOf(files),
                   "use maps of the undistorted images of this workspace");
      if (external.camera) {
        cameras_.push_back({files.image, *external.camera});
      }
      AddFacing(external, CameraOf(files), &facing_);
      summary_.num_with_normals += external.normal.Empty() ? 0 : 1;
      scales_.push_back(BaseScale(external.is_integer));
      comparisons_.push_back(CompareWithSparse(
          model_, files.image, ScaledDepth(external.depth, scales_.back())));
      if (CountDepths(external.depth) == 0) {
        summary_.warnings.push_back(files.depth.string() +
                                    ": no pixel has a depth");
      }
      progress_.Advance(true);
    }
    progress_.Finish();
  }

  void DecideScales() {
    summary_.scale = JudgeScale(comparisons_);
    summary_.has_own_scales = options_.scale_to_sparse;
    if (options_.scale_to_sparse) {
      ScaleEachImage();
      return;
    }
    const ScaleVerdict& scale = summary_.scale;
    if (options_.check_scale && scale.is_consistent &&
        IsOffScale(scale.median)) {
      const std::string suggestion = Text("%.3g", scales_[0] / scale.median);
      throw Error::File(
          ErrorCode::kMismatch,
          options_.match.input_path.string(),
          "depths are " + Text("%.4g", scale.median) +
              " times those of the sparse points in all images, so they seem "
              "to be in other units",
          "give " + OptionName("depth_scale") + " " + suggestion + ", or " +
              OptionName("check_scale") + " 0 to take them as they are");
    }
    if (scale.num_images == 0) {
      summary_.warnings.push_back(
          "no image has " + std::to_string(kMinSparsePoints) +
          " sparse points on its depth, so nothing tells whether the units are "
          "right");
    }
    bool is_any_off = false;
    for (size_t i = 0; i < matched_.files.size(); ++i) {
      const SparseComparison& comparison = comparisons_[i];
      if (comparison.num_points >= kMinSparsePoints &&
          IsOffScale(comparison.ratio)) {
        is_any_off = true;
        summary_.warnings.push_back(
            NameOf(matched_.files[i]) + ": depths are " +
            Text("%.3g", comparison.ratio) + " times those of its " +
            std::to_string(comparison.num_points) + " sparse points");
      }
    }
    if (!scale.is_consistent && is_any_off) {
      summary_.warnings.push_back("the images' scales differ; " +
                                  OptionName("scale_to_sparse") +
                                  " 1 gives each its own");
    }
  }

  void ScaleEachImage() {
    for (size_t i = 0; i < matched_.files.size(); ++i) {
      const SparseComparison& comparison = comparisons_[i];
      if (comparison.num_points < kMinSparsePoints) {
        throw Error::File(ErrorCode::kMismatch,
                          matched_.files[i].depth.string(),
                          "only " + std::to_string(comparison.num_points) +
                              " sparse points of " + NameOf(matched_.files[i]) +
                              " lie on its depth, too few to tell a scale",
                          "take this map away, or go without " +
                              OptionName("scale_to_sparse"));
      }
      scales_[i] /= comparison.ratio;
    }
  }

  void WriteMaps(const std::filesystem::path& root, MapType type) {
    const bool in_world = AreInWorld(facing_, options_.match.format);
    progress_.Start(static_cast<int>(matched_.files.size()), "Importing:");
    for (size_t i = 0; i < matched_.files.size(); ++i) {
      ThrowIfStopped();
      const ExternalFiles& files = matched_.files[i];
      const ImportedMaps maps =
          ConvertMaps(ReadExternalMaps(files, options_.match.format),
                      CameraOf(files),
                      scales_[i],
                      in_world);
      const MapPaths paths = GetMapPaths(root, NameOf(files), type);
      CreateFolders(paths.depth.Parent());
      CreateFolders(paths.normal.Parent());
      WriteDepthMap(paths.depth, maps.depth);
      WriteNormalMap(paths.normal, maps.normal);
      summary_.num_pixels += static_cast<int64_t>(maps.depth.NumPixels());
      summary_.num_with_depth += CountDepths(maps.depth);
      progress_.Advance(true);
    }
    progress_.Finish();
    summary_.num_kept = summary_.num_with_depth;
  }

  void Filter(const std::filesystem::path& root) {
    const Workspace workspace(root, MapType::kPhotometric);
    const std::function<bool()> never = [] { return false; };
    FilterMaps(workspace,
               options_.device,
               progress_,
               should_stop_ ? should_stop_ : never);
    summary_.num_kept = 0;
    for (const ExternalFiles& files : matched_.files) {
      const auto paths = [&](MapType type) {
        return GetMapPaths(root, NameOf(files), type);
      };
      RemoveFile(paths(MapType::kPhotometric).depth);
      RemoveFile(paths(MapType::kPhotometric).normal);
      summary_.num_kept +=
          CountDepths(ReadDepthMap(paths(MapType::kGeometric).depth));
    }
  }

  const ImportOptions& options_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  const SparseModel model_;
  const MatchedMaps matched_;
  ImportSummary summary_;
  // For each of matched_.files.
  std::vector<double> scales_;
  std::vector<SparseComparison> comparisons_;
  std::vector<AssignedCamera> cameras_;
  NormalFacing facing_;
};

}  // namespace

ImportSummary ImportWorkspace(const ImportOptions& options,
                              Progress& progress,
                              const std::function<bool()>& should_stop) {
  return Importer(options, progress, should_stop).Run();
}

}  // namespace tsar
