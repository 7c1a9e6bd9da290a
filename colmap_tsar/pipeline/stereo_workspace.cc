// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/stereo_workspace.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/pipeline/image_runner.h"
#include "colmap_tsar/pipeline/memory_plan.h"
#include "colmap_tsar/pipeline/refine_devices.h"
#include "colmap_tsar/pipeline/stereo_image.h"
#include "colmap_tsar/pipeline/view_cache.h"
#include "colmap_tsar/workspace/atomic_file.h"
#include "colmap_tsar/workspace/links.h"
#include "colmap_tsar/workspace/map_io.h"
#include "colmap_tsar/workspace/output_workspace.h"
#include "colmap_tsar/workspace/photo.h"
#include "colmap_tsar/workspace/workspace_lock.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

#include <glog/logging.h>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// What this program keeps between the passes and from run to run.
fs::path OwnFolder(const Workspace& workspace) {
  return workspace.Root() / "stereo" / "tsar_stereo";
}

struct MapFiles {
  fs::path depth;
  fs::path normal;
  fs::path cost;  // Empty between the passes.

  bool Exist() const {
    return fs::exists(depth) && fs::exists(normal) &&
           (cost.empty() || fs::exists(cost));
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
      const fs::path folder =
          OwnFolder(workspace_) / ("pass_" + std::to_string(pass));
      return {folder / "depth" / (key + ".bin"),
              folder / "normal" / (key + ".bin"),
              {}};
    }
    const MapPaths paths = workspace_.Paths(
        image, pass == 0 ? MapType::kPhotometric : MapType::kGeometric);
    return {paths.depth, paths.normal, paths.cost};
  }

  // Once the last pass is done.
  void RemoveFilesBetween() const {
    for (int pass = 1; pass < num_geometric_; ++pass) {
      std::error_code ignored;
      fs::remove_all(OwnFolder(workspace_) / ("pass_" + std::to_string(pass)),
                     ignored);
    }
  }

 private:
  const Workspace& workspace_;
  const int num_geometric_;
};

void WriteMaps(const MapFiles& files, const StereoMaps& maps) {
  for (const fs::path& path : {files.depth, files.normal, files.cost}) {
    if (!path.empty()) {
      CreateFolders(path.parent_path());
    }
  }
  if (!files.cost.empty()) {
    PlanarMap costs;
    costs.width = maps.depth.Width();
    costs.height = maps.depth.Height();
    costs.channels = 2;
    costs.values.assign(maps.min_cost.begin(), maps.min_cost.end());
    costs.values.insert(
        costs.values.end(), maps.second_cost.begin(), maps.second_cost.end());
    WritePlanarMap(files.cost, costs);
  }
  WriteNormalMap(files.normal, maps.normal);
  WriteDepthMap(files.depth, maps.depth);
}

std::string ReadText(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file),
                     std::istreambuf_iterator<char>());
}

// The size of an image's maps.
std::pair<int, int> MapSizeOf(const Camera& camera, int max_image_size) {
  const int side = std::max(camera.width, camera.height);
  const double scale = max_image_size > 0 && max_image_size < side
                           ? static_cast<double>(max_image_size) / side
                           : 1.0;
  return {std::max(1, static_cast<int>(std::lround(camera.width * scale))),
          std::max(1, static_cast<int>(std::lround(camera.height * scale)))};
}

bool IsMapOfSize(const fs::path& path, int width, int height) {
  try {
    const MapSize size = ReadMapSize(path);
    return size.width == width && size.height == height;
  } catch (const Error&) {
    return false;  // Not even a map.
  }
}

// Whether all maps that lie there have the sizes of this run's: images may have
// been undistorted to another size meanwhile.
bool HaveRightSizes(const Workspace& workspace, const StereoOptions& options) {
  const Passes passes(workspace, options);
  for (const StereoProblem& problem : workspace.Problems()) {
    const auto [width, height] = MapSizeOf(
        workspace.Model().images[static_cast<size_t>(problem.reference)].camera,
        options.max_image_size);
    for (int pass = 0; pass < passes.Num(); ++pass) {
      const MapFiles files = passes.Files(pass, problem.reference);
      for (const fs::path& path : {files.depth, files.normal}) {
        if (fs::exists(path) && !IsMapOfSize(path, width, height)) {
          return false;
        }
      }
    }
  }
  return true;
}

// Sees to it that all maps there are come from a run with these options, of
// which a former run may have done a part.
void ClaimMaps(const Workspace& workspace,
               const StereoOptions& options,
               bool overwrite) {
  const fs::path state_path = OwnFolder(workspace) / "options.txt";
  const bool is_ours = fs::exists(state_path) &&
                       ReadText(state_path) == options.Text() &&
                       HaveRightSizes(workspace, options);
  // All of it is looked at before the first file goes.
  std::vector<fs::path> foreign;
  for (const StereoProblem& problem : workspace.Problems()) {
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      const MapPaths paths = workspace.Paths(problem.reference, type);
      if (fs::exists(paths.original_depth)) {
        throw Error::File(ErrorCode::kUnsupported,
                          paths.depth.string(),
                          "has been refined",
                          "run tsar_refine with --restore 1 first");
      }
      for (const fs::path& path : {paths.depth, paths.normal, paths.cost}) {
        if (!is_ours && fs::exists(path)) {
          foreign.push_back(path);
        }
      }
    }
  }
  if (!foreign.empty() && !overwrite) {
    throw Error::File(
        ErrorCode::kUnsupported,
        foreign.front().string(),
        "is of another program, or was made with other options",
        "give --overwrite 1 to replace all maps, or work on a copy");
  }
  for (const fs::path& path : foreign) {
    RemoveFile(path);
  }
  if (!is_ours) {
    std::error_code ignored;
    fs::remove_all(OwnFolder(workspace), ignored);
    CreateFolders(OwnFolder(workspace));
    AtomicFile file(state_path);
    file.Stream() << options.Text();
    file.Commit();
  }
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
        passes_(workspace, options) {}

  int NumPasses() const { return passes_.Num(); }
  const Passes& AllPasses() const { return passes_; }

  // The sources that are used.
  std::vector<int> Sources(const StereoProblem& problem) const {
    std::vector<int> sources = problem.sources;
    if (sources.size() > static_cast<size_t>(options_.num_sources)) {
      sources.resize(static_cast<size_t>(options_.num_sources));
    }
    return sources;
  }

  DepthInterval RangeOf(int image) const {
    if (options_.depth_min > 0.0) {
      return {options_.depth_min, options_.depth_max};
    }
    const std::optional<DepthInterval> range =
        SparseDepthInterval(workspace_.Model(), image);
    if (!range) {
      throw Error::File(ErrorCode::kNotFound,
                        workspace_.ImagePath(image).string(),
                        "sees none of the sparse points, so that its depths "
                        "cannot be guessed",
                        "give --TsarStereo.depth_min and depth_max");
    }
    return *range;
  }

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
      for (RefineWorker& worker : devices_.workers) {
        threads.emplace_back([&] {
          while (!has_failed_ && !should_stop_()) {
            const size_t index = next++;
            if (index >= workspace_.Problems().size()) {
              return;
            }
            Try([&] {
              const bool was_done =
                  !RunImage(pass, index, *worker.device, cache);
              num_skipped += was_done ? 1 : 0;
            });
          }
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

  // The image and, after the first pass, its maps so far.
  ViewCache::View Load(int pass, int image) const {
    auto view = std::make_shared<ViewData>();
    const Camera& camera =
        workspace_.Model().images[static_cast<size_t>(image)].camera;
    const auto [width, height] = MapSizeOf(camera, options_.max_image_size);
    view->color = workspace_.ReadImage(image, width, height);
    view->camera = camera.Resized(width, height);
    if (pass > 0) {
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
    const std::vector<int> sources = Sources(problem);
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
    const DepthInterval range = RangeOf(problem.reference);
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
      CreateFolders(run.workspace_path / "stereo" / folder);
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
  RefineDevices devices =
      CreateRefineDevices(run, overview, summary.num_images);
  summary.device = devices.description;
  StereoRun stereo(
      workspace, options, devices, overview, progress, should_stop);
  for (const StereoProblem& problem : workspace.Problems()) {
    if (problem.sources.empty()) {
      summary.without_sources.push_back(
          workspace.Model()
              .images[static_cast<size_t>(problem.reference)]
              .name);
    } else {
      stereo.RangeOf(problem.reference);
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
