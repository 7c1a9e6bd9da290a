// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/write_page.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/input_folders.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/output_folder.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/plane_export/export_planes.h"
#include "colmap_tsar/tools/report/page_data.h"
#include "colmap_tsar/tools/report/page_text.h"
#include "colmap_tsar/tools/report/point_sample.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace tsar {
namespace {

// The folder of a page.
inline constexpr OutputFolderKind kPageFolder = {"report",
                                                 "a report",
                                                 "tsar_report",
                                                 "report_path",
                                                 "data/report.js",
                                                 "data/files.txt",
                                                 "unfinished_page"};

namespace fs = std::filesystem;

// The placeholder in page/index.html for the name of the workspace.
constexpr std::string_view kTitle = "@TITLE@";
constexpr std::string_view kPointNames[] = {"before", "after"};
constexpr std::string_view kPlaneMeshName = "planes";

void Check(const PageOptions& options) {
  if (options.fuse) {
    if (!options.before_path.empty() && !options.after_path.empty()) {
      throw Error(ErrorCode::kBadOption,
                  OptionName("fuse") + " makes the clouds that " +
                      OptionName("before_path") + " and " +
                      OptionName("after_path") +
                      " do not give; both are given, so leave it out");
    }
    return;
  }
  if (!options.before_path.empty() && options.after_path.empty()) {
    throw Error(ErrorCode::kBadOption,
                OptionName("before_path") + " is compared with " +
                    OptionName("after_path") + "; give that cloud, too");
  }
  // Points of unfused maps would score too low.
  if (!options.scans_path.empty() && options.before_path.empty()) {
    throw Error(ErrorCode::kBadOption,
                OptionName("scans_path") + " is for clouds; give " +
                    OptionName("before_path") + " and " +
                    OptionName("after_path") + ", too");
  }
}

std::vector<int> RequireRefinedImages(const Workspace& workspace) {
  const std::vector<int> refined = FindRefinedImages(workspace);
  if (refined.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      workspace.Root().string(),
                      "has no refined " + ToString(workspace.Type()) + " maps",
                      "run tsar_refine on it first");
  }
  return refined;
}

// The clouds before (0) and after (1) of a page.
using Clouds = std::array<fs::path, 2>;

// The clouds of the options; those not given are fused, if they say how.
Clouds MakeClouds(const Workspace& workspace,
                  const PageOptions& options,
                  const fs::path& folder,
                  Progress& progress,
                  const std::function<bool()>& should_stop) {
  Clouds clouds = {options.before_path, options.after_path};
  if (!options.fuse) {
    return clouds;
  }
  CreateFolders(UserPath(folder));
  for (size_t i = 0; i < clouds.size(); ++i) {
    if (clouds[i].empty()) {
      clouds[i] = folder / (std::string(kPointNames[i]) + ".ply");
      options.fuse(workspace, i == 0, clouds[i], progress, should_stop);
    }
  }
  return clouds;
}

void WriteText(const ContainedPath& path, std::string_view text) {
  CreateFolders(path.Parent());
  AtomicFile file(path);
  file.Stream() << text;
  file.Commit();
}

void WritePoints(const fs::path& folder,
                 std::string_view name,
                 const PointSample& points) {
  const std::string text(name);
  WriteText({folder, fs::path("data") / ("points_" + text + ".js")},
            PointScript(text, points));
}

void WriteStaticFiles(const std::string& title, const fs::path& folder) {
  for (const PageFile& file : PageFiles()) {
    std::string content(file.content);
    ReplaceAll(kTitle, title, &content);

    WriteText({folder, file.name}, content);
  }
}

// The name of the workspace's folder, which identifies it.
std::string WorkspaceName(const Workspace& workspace) {
  const fs::path root = fs::absolute(workspace.Root()).lexically_normal();
  return (root.has_filename() ? root : root.parent_path()).filename().string();
}

std::vector<KeptImage> ListKept(const Workspace& workspace,
                                const std::vector<int>& refined) {
  std::vector<KeptImage> kept;
  for (const StereoProblem& problem : workspace.Problems()) {
    const int image = problem.reference;
    if (std::ranges::binary_search(refined, image)) {
      continue;
    }
    const std::optional<ImageRecord> record =
        ReadRecord(workspace.Paths(image, workspace.Type()).record);
    kept.push_back(
        {workspace.Model().images[image].name,
         record && !record->note.empty() ? record->note : "not refined yet"});
  }
  return kept;
}

const Camera& CameraOf(const Workspace& workspace, int image) {
  return workspace.Model().images[image].camera;
}

Eigen::Vector3d MeanCenter(const Workspace& workspace,
                           const std::vector<int>& images) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const int image : images) {
    sum += CameraOf(workspace, image).Center();
  }
  return sum / static_cast<double>(images.size());
}

// Sets the viewpoint, for these points, to the image that sees most of them or,
// if none does, to the middle one of the list; up is the mean of the images'.
void SetViewpoint(const Workspace& workspace,
                  const std::vector<int>& images,
                  const PointSample& points,
                  const Eigen::Vector3d& origin,
                  PointView* view) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  std::vector<Camera> cameras;
  for (const int image : images) {
    cameras.push_back(CameraOf(workspace, image));
    up -= cameras.back().rotation.row(1).transpose();
  }
  view->eye = cameras[cameras.size() / 2].Center() - origin;
  if (const auto best = ChooseViewpoint(cameras, points, origin)) {
    view->eye = best->eye;
    view->target = best->target;
  }
  // The up vectors of cameras may cancel out.
  if (up.norm() > 1e-3 * static_cast<double>(images.size())) {
    view->up = up.normalized();
  }
}

void CheckStages(const Workspace& workspace,
                 const std::vector<int>& refined,
                 const fs::path& debug_path) {
  const auto has_stages = [&](int image) {
    const auto& model_image = workspace.Model().images[image];
    return !FindStagePictures(debug_path, model_image.name).empty();
  };
  if (!debug_path.empty() && std::ranges::none_of(refined, has_stages)) {
    throw Error::File(ErrorCode::kNotFound,
                      debug_path.string(),
                      "holds no pictures of these images",
                      "give " + OptionName("debug_path") +
                          " the folder that tsar_refine wrote its pictures to");
  }
}

std::vector<ImagePage> WriteImages(const Workspace& workspace,
                                   const std::vector<int>& refined,
                                   const fs::path& folder,
                                   const ImagePageOptions& options,
                                   int num_threads,
                                   Progress& progress,
                                   const std::function<bool()>& should_stop) {
  std::vector<ImagePage> pages(refined.size());
  progress.Start(static_cast<int>(refined.size()));
  ForEachImage(workspace, refined, num_threads, [&](size_t i) {
    if (should_stop()) {
      throw Error(ErrorCode::kInterrupted, "interrupted; no page was written");
    }
    pages[i] = WriteImagePage(
        workspace, refined[i], static_cast<int>(i), folder, options);
    progress.Advance(true);
  });
  progress.Finish();
  return pages;
}

// The points of the maps before (0) and after (1), moved out of the pages.
std::array<PointSample, 2> TakePoints(std::vector<ImagePage>* pages) {
  std::array<PointSample, 2> samples;
  for (ImagePage& page : *pages) {
    samples[0].Append(std::exchange(page.points_before, {}));
    samples[1].Append(std::exchange(page.points_after, {}));
  }
  return samples;
}

// Scores the original and the current maps of the workspace's type.
Gain<DepthEvaluation> EvaluateDepthGain(const Workspace& workspace,
                                        const PageOptions& options) {
  const MapType type = workspace.Type();
  DepthEvaluationOptions evaluation;
  evaluation.input_type = ToString(type);
  evaluation.ground_truth_path = options.ground_truth_path;
  evaluation.tolerances = options.tolerances;
  Gain<DepthEvaluation> gain;
  gain.after = EvaluateDepthMaps(workspace.Root(), evaluation);
  evaluation.find_map = [&](const std::string& name) {
    const int image = workspace.Model().IndexOf(name);
    return image < 0
               ? GetMapPaths(workspace.Root(), name, type).depth
               : FindOriginals(workspace.Paths(image, type)).depth.path;
  };
  gain.before = EvaluateDepthMaps(workspace.Root(), evaluation);
  return gain;
}

Gains Evaluate(const Workspace& workspace,
               const PageOptions& options,
               const Clouds& clouds) {
  Gains gains;
  if (!options.ground_truth_path.empty()) {
    gains.depth = EvaluateDepthGain(workspace, options);
  }
  if (!options.scans_path.empty()) {
    CloudEvaluationOptions evaluation;
    evaluation.tolerances = options.tolerances;
    gains.clouds = {
        EvaluateCloudFile(clouds[0], options.scans_path, evaluation),
        EvaluateCloudFile(clouds[1], options.scans_path, evaluation)};
  }
  return gains;
}

}  // namespace

int WritePage(const Workspace& workspace,
              const PageOptions& options,
              Progress& progress,
              const std::function<bool()>& should_stop) {
  Check(options);
  RequireOutsideInputs(
      workspace.Root(), options.report_path, OptionName("report_path"));
  // The lock keeps the maps before and after consistent.
  const WorkspaceLock lock(workspace.Root(), WorkspaceLock::Mode::kShared);
  const std::vector<int> refined = RequireRefinedImages(workspace);
  WarnOfChangedResults(workspace);

  CheckStages(workspace, refined, options.debug_path);
  OutputFolder folder(kPageFolder, options.report_path, options.overwrite);
  const fs::path& root = folder.Temporary();
  const Eigen::Vector3d origin = MeanCenter(workspace, refined);
  // These files are read before the long work on images, for early errors.
  PageData data;
  const fs::path fused = root / "fused";
  const Clouds clouds =
      MakeClouds(workspace, options, fused, progress, should_stop);
  data.points.fusion = options.fusion;

  data.points.from_clouds = !clouds[1].empty();
  data.points.before_from_maps = data.points.from_clouds && clouds[0].empty();
  std::array<PointSample, 2> samples;
  for (size_t i = 0; i < clouds.size(); ++i) {
    data.points.fused[i] = clouds[i].parent_path() == fused;
    if (!clouds[i].empty()) {
      samples[i] = SampleCloud(clouds[i], origin, options.max_num_points);
    }
  }
  data.gains = Evaluate(workspace, options, clouds);
  if (options.fuse) {
    RemoveTree(UserPath(fused));
  }
  if (HasPlanes(workspace)) {
    data.planes = MakePlanePage(
        ExportPlanes(workspace, {}, progress, should_stop), origin);
    WritePoints(root, kPlaneMeshName, data.planes->mesh);
    data.planes->mesh = {};
  }
  data.version = TSAR_VERSION;
  data.workspace = WorkspaceName(workspace);
  data.type = ToString(workspace.Type());
  const ImagePageOptions of_images = {
      .max_picture_size = options.max_picture_size,
      .debug_path = options.debug_path,
      .show_planes = data.planes.has_value(),
      .origin = origin,
      .max_num_points =
          clouds[0].empty()
              ? std::max<int64_t>(1,
                                  options.max_num_points /
                                      static_cast<int64_t>(refined.size()))
              : 0};

  data.images = WriteImages(workspace,
                            refined,
                            root / "images",
                            of_images,
                            options.num_threads,
                            progress,
                            should_stop);
  data.kept = ListKept(workspace, refined);
  std::array<PointSample, 2> from_maps = TakePoints(&data.images);
  for (size_t i = 0; i < clouds.size(); ++i) {
    if (clouds[i].empty()) {
      samples[i] = std::move(from_maps[i]);
    }
  }
  SetViewpoint(workspace, refined, samples[1], origin, &data.points);
  for (size_t i = 0; i < samples.size(); ++i) {
    data.points.num_shown[i] = static_cast<int64_t>(samples[i].NumPoints());
    data.points.num_all[i] = samples[i].num_all;
    WritePoints(root, kPointNames[i], samples[i]);
  }
  WriteText({root, kPageFolder.known_file}, PageDataScript(data));
  WriteText({root, "data/images.csv"}, ImageTable(data));
  WriteStaticFiles(EscapeHtml(data.workspace), root);
  folder.Commit();
  return static_cast<int>(refined.size());
}

}  // namespace tsar
