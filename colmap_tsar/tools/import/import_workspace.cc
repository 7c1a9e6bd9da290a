// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/import_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/map_shape.h"
#include "colmap_tsar/io/sparse_model.h"
#include "colmap_tsar/run/store/input_folders.h"
#include "colmap_tsar/run/store/json_file.h"
#include "colmap_tsar/run/store/output_folder.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/tools/import/filter_maps.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

constexpr OutputFolderKind kImportFolder = {"import",
                                            "an import",
                                            "tsar_import",
                                            "output_path",
                                            "stereo/tsar_import.json",
                                            "stereo/tsar_import_files.txt",
                                            "unfinished_import"};

// A power of ten, such as that between millimeters and meters, where the factor
// is nearly that.
double RoundFactor(double factor) {
  constexpr double kMaxDeviation = 0.05;
  const double power = std::pow(10.0, std::round(std::log10(factor)));
  return std::abs(factor / power - 1.0) < kMaxDeviation ? power : factor;
}

int64_t CountDepths(const Image<float>& depth) {
  return std::ranges::count_if(depth, [](float value) { return value > 0.f; });
}

// Gives an empty folder what COLMAP's dense stage needs besides maps: the
// photos of the model's images, as hard links where the file system allows, a
// copy of the model's files, and configuration files with all images and
// `__auto__, 20`. Photos that are missing are left out.
void WriteInputs(const fs::path& source,
                 const SparseModel& model,
                 const ContainedPath& root) {
  const ContainedPath stereo = root / "stereo";
  for (const ContainedPath& folder : {root / "images",
                                      root / "sparse",
                                      stereo / "depth_maps",
                                      stereo / "normal_maps"}) {
    CreateFolders(folder);
  }
  AtomicFile patch_match(stereo / "patch-match.cfg");
  AtomicFile fusion(stereo / "fusion.cfg");
  for (const SparseModel::ModelImage& image : model.images) {
    patch_match.Stream() << image.name << "\n__auto__, 20\n";
    fusion.Stream() << image.name << "\n";
    std::error_code error;
    // A link to a photo may be relative.
    const fs::path photo = fs::canonical(source / "images" / image.name, error);
    if (!error) {
      LinkOrCopyFile(photo, root / "images" / image.name);
    }
  }
  patch_match.Commit();
  fusion.Commit();
  for (const fs::path& file : FindSparseModelFiles(FindModelFolder(source))) {
    CopyFile(file, root / "sparse" / file.filename());
  }
}

class Importer {
 public:
  Importer(const ImportOptions& options, Progress& progress)
      : options_(options),
        progress_(progress),
        model_(ReadTargetModel(options.workspace_path)) {
    const MatchedMaps matched = MatchImages(options.match, model_);
    for (const ExternalFiles& files : matched.files) {
      maps_.push_back({files, model_.images[files.image]});
    }
    summary_.output_path = options.output_path;
    summary_.type = options.match.type;
    summary_.num_images = static_cast<int>(model_.images.size());
    summary_.num_imported = static_cast<int>(maps_.size());
    summary_.num_without_image = matched.num_without_image;
  }

  ImportSummary Run() {
    RequireOutsideInputs(options_.workspace_path,
                         options_.output_path,
                         OptionName("output_path"));
    OutputFolder folder(
        kImportFolder, options_.output_path, options_.overwrite);
    const ContainedPath root(folder.Temporary(), {});
    CheckFiles();
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
  // What is imported of one image.
  struct Map {
    ExternalFiles files;
    const SparseModel::ModelImage& image;
    double scale = 1.0;
    SparseComparison sparse{};
    float no_depth = 0.f;  // See FindNoDepth().
  };

  // Whether the format has normals in the world's frame.
  bool MustTurn() const {
    return options_.match.format == ExternalFormat::kAcm ||
           options_.match.format == ExternalFormat::kApd;
  }

  bool MustFilter() const {
    return options_.match.type == MapType::kGeometric && MustTurn();
  }

  // Reads all files once and keeps the data for the checks.
  void CheckFiles() {
    std::vector<AssignedCamera> cameras;
    progress_.Start(static_cast<int>(maps_.size()), "Checking:");
    for (Map& map : maps_) {
      progress_.ThrowIfStopped("interrupted; nothing was imported");
      ExternalMaps external =
          ReadExternalMaps(map.files, options_.match.format);
      RequireShape(map.files.depth,
                   {external.depth.Width(), external.depth.Height()},
                   {map.image.camera.width, map.image.camera.height},
                   "the image " + map.image.name,
                   "use maps of the undistorted images of this workspace");
      if (external.camera) {
        cameras.push_back({map.files.image, *external.camera});
      }
      DropNoDepth(map, &external);
      summary_.num_with_normals += external.normal.Empty() ? 0 : 1;
      constexpr double kMillimeter = 0.001;
      map.scale = options_.depth_scale > 0.0 ? options_.depth_scale
                  : external.is_integer      ? kMillimeter
                                             : 1.0;
      map.sparse = CompareWithSparse(
          model_, map.files.image, ScaledDepth(external.depth, map.scale));
      if (CountDepths(external.depth) == 0) {
        summary_.warnings.push_back(map.files.depth.string() +
                                    ": no pixel has a depth");
      }
      progress_.Advance(true);
    }
    progress_.Finish();
    const NormalVerdict verdict =
        normals_.Judge(MustTurn() ? NormalFrame::kWorld : NormalFrame::kCamera);
    frame_ = verdict.frame;
    if (!verdict.remark.empty()) {
      remarks_.Add({verdict.remark}, options_.match.input_path.string());
    }
    for (std::string& line : remarks_.Lines()) {
      summary_.warnings.push_back(std::move(line));
    }
    CheckCameras(cameras,
                 model_,
                 options_.depth_scale > 0.0 ? options_.depth_scale : 1.0);
  }

  // Drops the number that stands for "no depth" in this map, and looks at the
  // normals of the others.
  void DropNoDepth(Map& map, ExternalMaps* external) {
    MapSample sample(external->depth, external->normal);
    const float no_depth = FindNoDepth(sample, &model_, map.files.image);
    map.no_depth = no_depth;
    if (no_depth != 0.f) {
      no_depths_.insert(no_depth);
      remarks_.Add({NoDepthRemark(no_depth)}, map.files.depth.string());
      ClearNoDepth(no_depth, external->depth);
      ClearNoDepth(no_depth, sample.depth);
    }
    if (!external->normal.Empty()) {
      normals_.Add(sample, map.image.camera);
    }
  }

  void DecideScales() {
    std::vector<SparseComparison> comparisons;
    for (const Map& map : maps_) {
      comparisons.push_back(map.sparse);
    }
    summary_.scale = JudgeScale(comparisons);
    summary_.has_own_scales = options_.scale_to_sparse;
    if (options_.scale_to_sparse) {
      ScaleEachImage();
      return;
    }
    const ScaleVerdict& scale = summary_.scale;
    if (options_.check_scale && scale.is_consistent &&
        IsOffScale(scale.median)) {
      throw Error::File(
          ErrorCode::kMismatch,
          options_.match.input_path.string(),
          "depths are " + Formatted("%.4g", scale.median) +
              " times those of the sparse points in all images, so they seem "
              "to be in other units",
          "give " + OptionName("depth_scale") + " " +
              Formatted("%.3g", RoundFactor(maps_[0].scale / scale.median)) +
              ", or " + OptionName("check_scale") +
              " 0 to take them as they are");
    }
    if (scale.num_images == 0) {
      summary_.warnings.push_back(
          "no image has " + std::to_string(kMinSparsePoints) +
          " sparse points on its depth, so nothing tells whether the units are "
          "right");
    }
    bool is_any_off = false;
    for (const Map& map : maps_) {
      if (map.sparse.num_points >= kMinSparsePoints &&
          IsOffScale(map.sparse.ratio)) {
        is_any_off = true;
        summary_.warnings.push_back(
            map.image.name + ": depths are " +
            Formatted("%.3g", map.sparse.ratio) + " times those of its " +
            std::to_string(map.sparse.num_points) + " sparse points");
      }
    }
    if (!scale.is_consistent && is_any_off) {
      summary_.warnings.push_back("the images' scales differ; " +
                                  OptionName("scale_to_sparse") +
                                  " 1 gives each its own");
    }
  }

  void ScaleEachImage() {
    for (Map& map : maps_) {
      if (map.sparse.num_points < kMinSparsePoints) {
        throw Error::File(ErrorCode::kMismatch,
                          map.files.depth.string(),
                          "only " + std::to_string(map.sparse.num_points) +
                              " sparse points of " + map.image.name +
                              " lie on its depth, too few to tell a scale",
                          "take this map away, or go without " +
                              OptionName("scale_to_sparse"));
      }
      map.scale /= map.sparse.ratio;
    }
  }

  void WriteMaps(const fs::path& root, MapType type) {
    progress_.Start(static_cast<int>(maps_.size()), "Importing:");
    for (const Map& map : maps_) {
      progress_.ThrowIfStopped("interrupted; nothing was imported");
      ExternalMaps external =
          ReadExternalMaps(map.files, options_.match.format);
      ClearNoDepth(map.no_depth, external.depth);
      // In a map with one value only, no other value shows that it is too far.
      const auto [least, most] = std::ranges::minmax(external.depth);
      if (least == most && no_depths_.contains(most)) {
        ClearNoDepth(most, external.depth);
      }
      const ImportedMaps maps =
          ConvertMaps(external, map.image.camera, map.scale, frame_);
      const MapPaths paths = GetMapPaths(root, map.image.name, type);
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

  void Filter(const fs::path& root) {
    FilterMaps(
        Workspace(root, MapType::kPhotometric), options_.device, progress_);
    summary_.num_kept = 0;
    for (const Map& map : maps_) {
      const auto paths = [&](MapType type) {
        return GetMapPaths(root, map.image.name, type);
      };
      RemoveFile(paths(MapType::kPhotometric).depth);
      RemoveFile(paths(MapType::kPhotometric).normal);
      summary_.num_kept +=
          CountDepths(ReadDepthMap(paths(MapType::kGeometric).depth));
    }
  }

  const ImportOptions& options_;
  Progress& progress_;
  const SparseModel model_;
  ImportSummary summary_;
  std::vector<Map> maps_;
  // The numbers that stand for "no depth" in any of the maps.
  std::set<float> no_depths_;
  NormalEvidence normals_;
  NormalFrame frame_ = NormalFrame::kCamera;
  ImageRemarks remarks_;
};

}  // namespace

SparseModel ReadTargetModel(const fs::path& root) {
  std::error_code error;
  for (const char* folder : {"images", "sparse"}) {
    if (!fs::is_directory(root / folder, error)) {
      throw Error::File(ErrorCode::kNotFound,
                        (root / folder).string(),
                        "no such folder, so this is not a dense workspace",
                        "check " + OptionName("workspace_path") +
                            ", or make the workspace with image_undistorter");
    }
  }
  const fs::path model_folder = FindModelFolder(root);
  SparseModel model = ReadWorkspaceModel(model_folder);
  if (model.images.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      model_folder.string(),
                      "the sparse model holds no images",
                      "make the workspace again with image_undistorter");
  }
  return model;
}

ImportSummary ImportWorkspace(const ImportOptions& options,
                              Progress& progress) {
  return Importer(options, progress).Run();
}

}  // namespace tsar
