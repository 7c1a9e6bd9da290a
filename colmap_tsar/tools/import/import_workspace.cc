// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/import/import_store.h"
#include "colmap_tsar/tools/import/target_workspace.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace tsar {
namespace {

using Path = std::filesystem::path;

std::string Text(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

// Extends a range by another one; (0, 0) is empty.
void Widen(float near, float far, float* total_near, float* total_far) {
  if (far > 0.f) {
    *total_near = *total_far > 0.f ? std::min(*total_near, near) : near;
    *total_far = std::max(*total_far, far);
  }
}

class Importer {
 public:
  Importer(const ImportOptions& options,
           Progress& progress,
           const std::function<bool()>& should_stop)
      : options_(options),
        progress_(progress),
        should_stop_(should_stop),
        root_(options.workspace_path),
        model_(ReadTargetModel(root_)),
        matched_(MatchImages(options.match, model_)) {
    summary_.workspace_path = root_;
    summary_.type = options.match.type;
    summary_.num_images = static_cast<int>(model_.images.size());
    summary_.num_imported = static_cast<int>(matched_.files.size());
    summary_.num_without_image = matched_.num_without_image;
  }

  ImportSummary Run() {
    const StereoFolder stereo(root_);
    const WorkspaceLock lock(root_);
    RequireUnrefined(root_);
    for (const ExternalFiles& files : matched_.files) {
      RequireNoStrayResults(
          GetMapPaths(root_, NameOf(files), options_.match.type));
      RequireNoFolders(root_, NameOf(files), options_.match.type);
      if (!options_.overwrite) {
        RequireNoForeignMaps(root_, NameOf(files), options_.match.type);
      }
    }
    CheckFiles();
    CheckCameras(cameras_,
                 model_,
                 options_.depth_scale > 0.0 ? options_.depth_scale : 1.0);
    CheckNormalFrame();
    DecideScales();
    NoteRanges();
    WriteMissingConfigs(root_, model_);
    WriteMaps();
    return std::move(summary_);
  }

 private:
  void ThrowIfStopped() const {
    if (should_stop_ && should_stop_()) {
      throw Error(ErrorCode::kInterrupted,
                  "stopped; run the same command again");
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

  bool AreNormalsInWorld() const {
    return options_.normal_frame == NormalFrame::kWorld ||
           (options_.normal_frame == NormalFrame::kAuto &&
            (options_.match.format == ExternalFormat::kAcm ||
             options_.match.format == ExternalFormat::kApd));
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
      NoteOtherType(files, external.depth);
      if (external.camera) {
        cameras_.push_back({files.image, *external.camera});
      }
      const NormalFacing facing = CountFacing(external, CameraOf(files));
      facing_.num_normals += facing.num_normals;
      facing_.num_facing_in_camera += facing.num_facing_in_camera;
      facing_.num_facing_in_world += facing.num_facing_in_world;
      summary_.num_with_normals += external.normal.Empty() ? 0 : 1;
      scales_.push_back(BaseScale(external.is_integer));
      comparisons_.push_back(CompareWithSparse(
          model_, files.image, ScaledDepth(external.depth, scales_.back())));
      progress_.Advance(true);
    }
    progress_.Finish();
  }

  // tsar_refine uses the maps of both types together.
  void NoteOtherType(const ExternalFiles& files, const Image<float>& depth) {
    const MapType other = options_.match.type == MapType::kGeometric
                              ? MapType::kPhotometric
                              : MapType::kGeometric;
    const Path path = GetMapPaths(root_, NameOf(files), other).depth;
    if (!Exists(path)) {
      return;
    }
    const MapSize size = ReadMapSize(path);
    if (size.width != depth.Width() || size.height != depth.Height()) {
      summary_.warnings.push_back(
          path.string() + ": is of another size (" +
          ToString(RasterSize{size.width, size.height}) +
          ") than the imported map (" +
          ToString(RasterSize{depth.Width(), depth.Height()}) +
          "); take it away before tsar_refine");
    }
  }

  void CheckNormalFrame() const {
    if (facing_.num_normals == 0) {
      return;
    }
    // In the correct frame, all normals face the camera or all face away.
    const auto agreement = [&](int64_t num_facing) {
      const double share = static_cast<double>(num_facing) /
                           static_cast<double>(facing_.num_normals);
      return std::max(share, 1.0 - share);
    };
    constexpr double kDoubtful = 0.9;
    constexpr double kCertain = 0.99;
    const double camera = agreement(facing_.num_facing_in_camera);
    const double world = agreement(facing_.num_facing_in_world);
    const bool in_world = AreNormalsInWorld();
    if ((in_world ? world : camera) < kDoubtful &&
        (in_world ? camera : world) > kCertain) {
      const std::string now = in_world ? "world" : "camera";
      const std::string better = in_world ? "camera" : "world";
      throw Error::File(ErrorCode::kMismatch,
                        options_.match.input_path.string(),
                        "the normals look in all directions if they are in the "
                        "frame of the " +
                            now + ", but in one if they are in that of the " +
                            better,
                        "give " + OptionName("normal_frame") + " " + better);
    }
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
            std::to_string(comparison.num_points) + " sparse points (" +
            Text("%.4g", comparison.near) + " to " +
            Text("%.4g", comparison.far) + " against " +
            Text("%.4g", comparison.sparse_near) + " to " +
            Text("%.4g", comparison.sparse_far) + ")");
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

  void NoteRanges() {
    for (size_t i = 0; i < matched_.files.size(); ++i) {
      const SparseComparison& comparison = comparisons_[i];
      const auto factor = static_cast<float>(
          options_.scale_to_sparse ? 1.0 / comparison.ratio : 1.0);
      Widen(factor * comparison.near,
            factor * comparison.far,
            &summary_.near,
            &summary_.far);
      Widen(comparison.sparse_near,
            comparison.sparse_far,
            &summary_.sparse_near,
            &summary_.sparse_far);
      if (!(comparison.far > 0.f)) {
        summary_.warnings.push_back(matched_.files[i].depth.string() +
                                    ": no pixel has a depth");
      }
    }
  }

  void WriteMaps() {
    ConvertOptions convert;
    convert.normals_in_world = AreNormalsInWorld();
    convert.use_costs = options_.import_costs;
    progress_.Start(static_cast<int>(matched_.files.size()), "Importing:");
    for (size_t i = 0; i < matched_.files.size(); ++i) {
      ThrowIfStopped();
      const ExternalFiles& files = matched_.files[i];
      convert.scale = scales_[i];
      const ImportedMaps maps =
          ConvertMaps(ReadExternalMaps(files, options_.match.format),
                      CameraOf(files),
                      convert);
      WriteImported(root_, NameOf(files), options_.match.type, maps);
      summary_.num_with_costs += maps.cost.values.empty() ? 0 : 1;
      summary_.num_pixels += static_cast<int64_t>(maps.depth.NumPixels());
      summary_.num_with_depth += std::ranges::count_if(
          maps.depth, [](float depth) { return depth > 0.f; });
      progress_.Advance(true);
    }
    progress_.Finish();
  }

  const ImportOptions& options_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  const Path root_;
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
