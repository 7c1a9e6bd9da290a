// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/io/photo.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/refine_devices.h"
#include "colmap_tsar/run/refine_plan.h"
#include "colmap_tsar/run/store/links.h"
#include "colmap_tsar/run/store/output_workspace.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/stereo/fill_under_prior.h"
#include "colmap_tsar/tools/stereo/stereo_claim.h"
#include "colmap_tsar/tools/stereo/stereo_images.h"
#include "colmap_tsar/tools/stereo/stereo_inputs.h"
#include "colmap_tsar/tools/stereo/stereo_memory.h"
#include "colmap_tsar/tools/stereo/stereo_passes.h"
#include "colmap_tsar/tools/stereo/stereo_task.h"

#include <algorithm>
#include <set>
#include <utility>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// The overview of the workspace for the devices before it has maps.
WorkspaceOverview OverviewOf(const Workspace& workspace,
                             const StereoOptions& options) {
  WorkspaceOverview overview;
  const auto look_at = [&](int image) {
    const Camera& camera = workspace.Model().images[image].camera;
    const auto [width, height] = MapSizeOf(camera, options.max_image_size);
    overview.max_num_pixels =
        std::max(overview.max_num_pixels, static_cast<int64_t>(width) * height);
    overview.max_num_image_pixels =
        std::max(overview.max_num_image_pixels,
                 static_cast<int64_t>(camera.width) * camera.height);
    CheckPhotoFile(workspace.ImagePath(image));
    workspace.CheckMask(image, {width, height});
    overview.has_masks = overview.has_masks || workspace.HasMask(image);
    overview.AddPrior(workspace.CheckPrior(image));
  };
  std::set<int> images;
  for (const StereoProblem& problem : workspace.Problems()) {
    images.insert(problem.reference);
    images.insert(problem.sources.begin(), problem.sources.end());
    overview.max_num_sources =
        std::max(overview.max_num_sources,
                 std::min(options.num_sources,
                          static_cast<int>(problem.sources.size())));
  }
  std::ranges::for_each(images, look_at);
  overview.has_costs = FillsUnderPrior(options);
  overview.has_maps.assign(workspace.Model().images.size(), true);
  return overview;
}

void CheckPriorOptions(const StereoImageFiles& files,
                       const StereoOptions& options) {
  RequirePathOfPriorType(files.prior_path, files.prior_type);
  if (!files.prior_path.empty() && !FillsUnderPrior(options)) {
    throw Error(ErrorCode::kBadOption,
                OptionName("prior_path") +
                    ": depth priors tell where unmeasured pixels are filled; "
                    "leave it out, or turn " +
                    OptionName("planar_prior") + " and " +
                    OptionName("geom_consistency") + " on");
  }
}

// Opens a workspace of image_undistorter with the folders for maps.
Workspace OpenForStereo(const fs::path& path, const StereoImageFiles& files) {
  if (path.empty()) {
    throw Error(ErrorCode::kBadOption,
                OptionName("workspace_path") + " is missing; give it");
  }
  if (const auto source = ReadOutputMarker(path)) {
    throw Error::File(
        ErrorCode::kUnsupported,
        path.string(),
        "tsar_refine made this workspace from " + source->string(),
        "make the maps of that one");
  }
  RequireFoldersInside(path);
  // image_undistorter creates these folders, but they may have been deleted
  // with their maps.
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    if (fs::is_directory(path / "stereo")) {
      CreateFolders({path, fs::path("stereo") / folder});
    }
  }
  Workspace workspace(path, MapType::kPhotometric);
  workspace.WarnOfSourcesLeftOut();
  workspace.UseMasks(files.mask_path);
  workspace.UsePriors(files.prior_path, files.prior_type);
  workspace.Priors().WarnOfStrayFiles();
  return workspace;
}

// The relative durations of the passes, measured on two cores: 2.5 : 1 : 0.1
// for the photometric one, a geometric one and that under the prior.
std::vector<double> PassCosts(const StereoPasses& passes) {
  std::vector<double> costs;
  for (int pass = 0; pass < passes.NumPasses(); ++pass) {
    costs.push_back(pass == 0 ? 2.5 : passes.IsUnderPrior(pass) ? 0.1 : 1.0);
  }
  return costs;
}

// Returns the reports of the images.
std::vector<ImageReport> RunPass(const Workspace& workspace,
                                 const StereoOptions& options,
                                 const StereoPasses& passes,
                                 int pass,
                                 std::vector<size_t> images,
                                 int64_t view_bytes,
                                 RefineDevices& devices,
                                 Progress& progress,
                                 const std::function<bool()>& should_stop) {
  const std::string name =
      std::to_string(pass + 1) + " of " + std::to_string(passes.NumPasses());
  StereoTask task(workspace, options, passes, pass, devices.workers);
  ViewCache cache(devices.cache_num_bytes,
                  static_cast<size_t>(view_bytes),
                  [&](int image) { return task.Load(image); });
  progress.BeginPass();
  PipelineOutcome outcome = ImagePipeline<StereoMaps>(task,
                                                      std::move(images),
                                                      "Pass " + name + ":",
                                                      cache,
                                                      devices.sizes,
                                                      progress,
                                                      should_stop)
                                .Run(devices.workers.size());
  outcome.RethrowFailure();
  if (!outcome.IsComplete()) {
    throw Error(ErrorCode::kInterrupted,
                "interrupted in pass " + name +
                    "; run the same command again to go on");
  }
  return std::move(outcome.reports);
}

int CountSkipped(const std::vector<ImageReport>& reports) {
  return static_cast<int>(
      std::ranges::count_if(reports, [](const ImageReport& report) {
        return report.outcome == ImageReport::Outcome::kSkipped;
      }));
}

const std::string& NameOf(const Workspace& workspace, size_t place) {
  const StereoProblem& problem = workspace.Problems()[place];
  return workspace.Model().images[problem.reference].name;
}

}  // namespace

StereoSummary MatchWorkspace(const std::filesystem::path& workspace_path,
                             const DeviceOptions& device_options,
                             const StereoOptions& options,
                             bool overwrite,
                             Progress& progress,
                             const std::function<bool()>& should_stop,
                             const StereoImageFiles& files) {
  device_options.Check();
  options.Check();
  CheckPriorOptions(files, options);
  const Stopwatch stopwatch;
  const Workspace workspace = OpenForStereo(workspace_path, files);
  const WorkspaceLock lock(workspace.Root());
  const std::vector<bool> is_listed =
      FindListedImages(workspace, files.image_list_path);
  const WorkspaceOverview overview = OverviewOf(workspace, options);
  StereoSummary summary;
  summary.workspace_path = workspace.Root();
  summary.type =
      options.geom_consistency ? MapType::kGeometric : MapType::kPhotometric;
  const StereoPasses passes(workspace, options);
  const std::vector<std::vector<size_t>> images =
      FindImagesOfPasses(workspace, options, passes.NumPasses(), is_listed);
  summary.num_images = static_cast<int>(images.back().size());
  const std::vector<int> references = workspace.ReferencesOf(images.back());
  summary.num_masks = workspace.CountMasks(references);
  summary.num_priors = workspace.Priors().Count(references);
  if (overview.max_num_sources == 0) {
    throw Error::File(
        ErrorCode::kNotFound,
        (workspace.Root() / "stereo" / "patch-match.cfg").string(),
        "names no image with sources",
        "an image needs others that share sparse points with it");
  }
  RefineDevices devices = CreateRefineDevices(
      device_options,
      overview,
      [&](const WorkspaceOverview& maps) { return PlanStereo(options, maps); },
      static_cast<int>(images.front().size()));
  summary.device = devices.description;
  for (const size_t place : images.back()) {
    const StereoProblem& problem = workspace.Problems()[place];
    if (problem.sources.empty()) {
      summary.without_sources.push_back(
          {NameOf(workspace, place), problem.without_sources});
    }
  }
  ClaimMaps(workspace, options, overwrite, is_listed);
  const bool is_done = std::ranges::all_of(images.back(), [&](size_t place) {
    const StereoProblem& problem = workspace.Problems()[place];
    return problem.sources.empty() || passes.IsDone(problem.reference);
  });
  const auto num_without_sources =
      static_cast<int>(summary.without_sources.size());
  if (is_done) {
    // The intermediate files are gone and need not be made again.
    summary.num_skipped = summary.num_images - num_without_sources;
  } else {
    progress.PlanPasses(PassCosts(passes));
    for (int pass = 0; pass < passes.NumPasses(); ++pass) {
      const std::vector<size_t>& places = images[pass];
      const std::vector<ImageReport> reports = RunPass(workspace,
                                                       options,
                                                       passes,
                                                       pass,
                                                       places,
                                                       ViewBytes(overview),
                                                       devices,
                                                       progress,
                                                       should_stop);
      summary.num_skipped = CountSkipped(reports) - num_without_sources;
      for (size_t i = 0; i < places.size(); ++i) {
        if (is_listed[places[i]] && reports[i].prior.IsDropped()) {
          summary.dropped_priors.push_back(
              {NameOf(workspace, places[i]), Describe(reports[i].prior)});
        }
      }
    }
  }
  passes.RemoveFilesBetween();
  summary.peak_gpu_memory = PeakGpuMemory(devices);
  summary.wall_seconds = stopwatch.Seconds();
  return summary;
}

}  // namespace tsar
