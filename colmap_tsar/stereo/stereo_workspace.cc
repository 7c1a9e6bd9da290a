// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/stereo/stereo_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/start_thread.h"
#include "colmap_tsar/controllers/image_runner.h"
#include "colmap_tsar/controllers/memory_plan.h"
#include "colmap_tsar/controllers/refine_devices.h"
#include "colmap_tsar/controllers/view_cache.h"
#include "colmap_tsar/stereo/stereo_claim.h"
#include "colmap_tsar/stereo/stereo_image.h"
#include "colmap_tsar/stereo/stereo_inputs.h"
#include "colmap_tsar/stereo/stereo_memory.h"
#include "colmap_tsar/store/links.h"
#include "colmap_tsar/store/output_workspace.h"
#include "colmap_tsar/store/workspace_lock.h"
#include "colmap_tsar/workspace/map_io.h"
#include "colmap_tsar/workspace/photo.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

namespace tsar {
namespace {

namespace fs = std::filesystem;

struct MapFiles {
  ContainedPath depth;
  ContainedPath normal;
  std::optional<ContainedPath> cost;  // Not between the passes.

  bool Exist() const {
    return fs::exists(depth) && fs::exists(normal) &&
           (!cost || fs::exists(*cost));
  }
};

// The passes over all images: the photometric one and, after it, the geometric
// ones.
class Passes {
 public:
  Passes(const Workspace& workspace, const StereoOptions& options)
      : workspace_(workspace),
        num_geometric_(options.geom_consistency ? options.num_geometric_passes
                                                : 0) {}

  int Num() const { return 1 + num_geometric_; }

  // What pass number `pass` makes of an image.
  MapFiles Files(int pass, int image) const {
    if (pass > 0 && pass < num_geometric_) {
      const std::string key =
          workspace_.Model().images[static_cast<size_t>(image)].name;
      const ContainedPath folder =
          GetStereoFolder(workspace_) / ("pass_" + std::to_string(pass));
      return {folder / "depth" / (key + ".bin"),
              folder / "normal" / (key + ".bin"),
              std::nullopt};
    }
    const MapPaths paths = workspace_.Paths(
        image, pass == 0 ? MapType::kPhotometric : MapType::kGeometric);
    return {paths.depth, paths.normal, paths.cost};
  }

  // Once the last pass is done.
  void RemoveFilesBetween() const {
    for (int pass = 1; pass < num_geometric_; ++pass) {
      RemoveTree(GetStereoFolder(workspace_) /
                 ("pass_" + std::to_string(pass)));
    }
  }

 private:
  const Workspace& workspace_;
  const int num_geometric_;
};

void WriteMaps(const MapFiles& files, const StereoMaps& maps) {
  CreateFolders(files.depth.Parent());
  CreateFolders(files.normal.Parent());
  if (files.cost) {
    CreateFolders(files.cost->Parent());
    PlanarMap costs;
    costs.width = maps.depth.Width();
    costs.height = maps.depth.Height();
    costs.channels = 2;
    costs.values.assign(maps.min_cost.begin(), maps.min_cost.end());
    costs.values.insert(
        costs.values.end(), maps.second_cost.begin(), maps.second_cost.end());
    WritePlanarMap(*files.cost, costs);
  }
  WriteNormalMap(files.normal, maps.normal);
  WriteDepthMap(files.depth, maps.depth);
}

// One run over a workspace.
class StereoRun {
 public:
  StereoRun(const Workspace& workspace,
            const StereoOptions& options,
            RefineDevices& devices,
            const WorkspaceOverview& overview,
            Progress& progress,
            const std::function<bool()>& should_stop)
      : workspace_(workspace),
        options_(options),
        devices_(devices),
        overview_(overview),
        progress_(progress),
        should_stop_(should_stop),
        passes_(workspace, options),
        is_matched_(workspace.Model().images.size()) {
    for (const StereoProblem& problem : workspace.Problems()) {
      is_matched_[static_cast<size_t>(problem.reference)] =
          !problem.sources.empty();
    }
  }

  int NumPasses() const { return passes_.Num(); }
  const Passes& AllPasses() const { return passes_; }

  // Images that were done before count as skipped.
  int RunPass(int pass) {
    ViewCache cache(devices_.cache_num_bytes,
                    static_cast<size_t>(ViewBytes(overview_)),
                    [&](int image) { return Load(pass, image); });
    progress_.Start(static_cast<int>(workspace_.Problems().size()),
                    "Pass " + std::to_string(pass + 1) + " of " +
                        std::to_string(NumPasses()) + ":");
    std::atomic<size_t> next = 0;
    std::atomic<int> num_skipped = 0;
    {
      std::vector<std::jthread> threads;
      threads.reserve(devices_.workers.size());
      const auto work = [&](RefineWorker& worker) {
        while (!has_failed_ && !should_stop_()) {
          const size_t index = next++;
          if (index >= workspace_.Problems().size()) {
            return;
          }
          Try([&] {
            const bool was_done = !RunImage(pass, index, *worker.device, cache);
            num_skipped += was_done ? 1 : 0;
          });
        }
      };
      for (RefineWorker& worker : devices_.workers) {
        Try([&] {
          threads.push_back(StartThread([&work, &worker] { work(worker); }));
        });
      }
    }
    progress_.Finish();
    if (first_failure_) {
      std::rethrow_exception(first_failure_);
    }
    if (should_stop_()) {
      throw Error(ErrorCode::kInterrupted,
                  "interrupted in pass " + std::to_string(pass + 1) + " of " +
                      std::to_string(NumPasses()) +
                      "; run the same command again to go on");
    }
    return num_skipped;
  }

 private:
  template <typename Function>
  void Try(Function function) {
    try {
      function();
    } catch (...) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (!first_failure_) {
        first_failure_ = std::current_exception();
      }
      has_failed_ = true;
    }
  }

  // The image and, after the first pass, its maps so far. What other images
  // have there is of former runs.
  ViewCache::View Load(int pass, int image) const {
    auto view = std::make_shared<ViewData>();
    const Camera& camera =
        workspace_.Model().images[static_cast<size_t>(image)].camera;
    const auto [width, height] = MapSizeOf(camera, options_.max_image_size);
    view->color = workspace_.ReadImage(image, width, height);
    view->camera = camera.Resized(width, height);
    if (pass > 0 && is_matched_[static_cast<size_t>(image)]) {
      const MapFiles files = passes_.Files(pass - 1, image);
      if (files.Exist()) {
        view->depth = ReadDepthMap(files.depth);
        view->normal = ReadNormalMap(files.normal);
      }
    }
    return view;
  }

  // Whether there was something to do.
  bool RunImage(int pass, size_t index, Device& device, ViewCache& cache) {
    const StereoProblem& problem = workspace_.Problems()[index];
    const MapFiles files = passes_.Files(pass, problem.reference);
    if (problem.sources.empty() || files.Exist()) {
      progress_.Advance(false);
      return false;
    }
    const std::vector<int> sources = StereoSources(problem, options_);
    std::vector<int> images = sources;
    images.push_back(problem.reference);
    ViewCache::Lease lease = cache.Reserve(images);
    if (!lease.Load(should_stop_)) {
      return true;
    }
    std::vector<const ViewData*> views;
    for (const int source : sources) {
      views.push_back(&lease.Get(source));
    }
    const ViewData& reference = lease.Get(problem.reference);
    const DepthInterval range =
        StereoDepths(workspace_, problem.reference, options_);
    const uint32_t stream = HashImageName(
        workspace_.Model().images[static_cast<size_t>(problem.reference)].name);
    const StereoMaps maps =
        pass == 0
            ? MatchImage(reference, views, range, stream, options_, device)
            : MatchImageGeometrically(
                  reference, views, range, stream, pass - 1, options_, device);
    lease = {};
    WriteMaps(files, maps);
    progress_.Advance(true);
    return true;
  }

  const Workspace& workspace_;
  const StereoOptions& options_;
  RefineDevices& devices_;
  const WorkspaceOverview& overview_;
  Progress& progress_;
  const std::function<bool()>& should_stop_;
  const Passes passes_;
  // By image.
  std::vector<bool> is_matched_;
  std::atomic<bool> has_failed_ = false;
  std::mutex mutex_;
  std::exception_ptr first_failure_;
};

// What the devices need to know of the workspace before it has maps.
WorkspaceOverview OverviewOf(const Workspace& workspace,
                             const StereoOptions& options) {
  WorkspaceOverview overview;
  const auto look_at = [&](int image) {
    const Camera& camera =
        workspace.Model().images[static_cast<size_t>(image)].camera;
    const auto [width, height] = MapSizeOf(camera, options.max_image_size);
    overview.max_num_pixels =
        std::max(overview.max_num_pixels, static_cast<int64_t>(width) * height);
    overview.max_num_image_pixels =
        std::max(overview.max_num_image_pixels,
                 static_cast<int64_t>(camera.width) * camera.height);
    CheckPhotoFile(workspace.ImagePath(image));
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
  std::for_each(images.begin(), images.end(), look_at);
  overview.has_maps.assign(workspace.Model().images.size(), true);
  return overview;
}

}  // namespace

StereoSummary MatchWorkspace(const WorkspaceRefineOptions& run,
                             const StereoOptions& options,
                             bool overwrite,
                             Progress& progress,
                             const std::function<bool()>& should_stop) {
  run.Check();
  options.Check();
  const auto start = std::chrono::steady_clock::now();
  if (const auto source = ReadOutputMarker(run.workspace_path)) {
    throw Error::File(
        ErrorCode::kUnsupported,
        run.workspace_path.string(),
        "tsar_refine made this workspace from " + source->string(),
        "make the maps of that one");
  }
  RequireFoldersInside(run.workspace_path);
  // image_undistorter makes them, but who has deleted maps may have deleted the
  // folders.
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    if (fs::is_directory(run.workspace_path / "stereo")) {
      CreateFolders({run.workspace_path, fs::path("stereo") / folder});
    }
  }
  const Workspace workspace(run.workspace_path, MapType::kPhotometric);
  const WorkspaceLock lock(workspace.Root());
  const WorkspaceOverview overview = OverviewOf(workspace, options);
  StereoSummary summary;
  summary.workspace_path = workspace.Root();
  summary.num_images = static_cast<int>(workspace.Problems().size());
  if (overview.max_num_sources == 0) {
    throw Error::File(
        ErrorCode::kNotFound,
        (workspace.Root() / "stereo" / "patch-match.cfg").string(),
        "names no image with sources",
        "an image needs others that share sparse points with it");
  }
  RefineDevices devices = CreateRefineDevices(
      run,
      overview,
      [&](const WorkspaceOverview& maps) { return PlanStereo(options, maps); },
      summary.num_images);
  summary.device = devices.description;
  StereoRun stereo(
      workspace, options, devices, overview, progress, should_stop);
  for (const StereoProblem& problem : workspace.Problems()) {
    if (problem.sources.empty()) {
      summary.without_sources.push_back(
          workspace.Model()
              .images[static_cast<size_t>(problem.reference)]
              .name);
    }
  }
  ClaimMaps(workspace, options, overwrite);
  // Where all final maps are there, what lay between the passes is gone.
  const bool is_done = std::all_of(
      workspace.Problems().begin(),
      workspace.Problems().end(),
      [&](const StereoProblem& problem) {
        return problem.sources.empty() ||
               (stereo.AllPasses().Files(0, problem.reference).Exist() &&
                stereo.AllPasses()
                    .Files(stereo.NumPasses() - 1, problem.reference)
                    .Exist());
      });
  if (is_done) {
    summary.num_skipped =
        summary.num_images - static_cast<int>(summary.without_sources.size());
  } else {
    for (int pass = 0; pass < stereo.NumPasses(); ++pass) {
      summary.num_skipped = stereo.RunPass(pass) -
                            static_cast<int>(summary.without_sources.size());
    }
  }
  stereo.AllPasses().RemoveFilesBetween();
  summary.peak_gpu_memory = PeakGpuMemory(devices);
  summary.wall_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
          .count();
  return summary;
}

}  // namespace tsar
