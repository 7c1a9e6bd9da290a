// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/io/photo.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/run/gpu_workers.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/image_selection.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/pipeline_devices.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/tools/stereo/stereo_inputs.h"

#include <algorithm>
#include <memory>
#include <thread>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// The files that one pass makes of one image.
struct StereoMapFiles {
  ContainedPath depth;
  ContainedPath normal;
  std::optional<ContainedPath> cost;  // Some passes have none.

  bool Exist() const {
    return fs::exists(depth) && fs::exists(normal) &&
           (!cost || fs::exists(*cost));
  }
};

// Writes each file atomically, the depth map last; creates the folders.
void WriteStereoMaps(const StereoMapFiles& files, const StereoMaps& maps) {
  CreateFolders(files.depth.Parent());
  CreateFolders(files.normal.Parent());
  if (files.cost) {
    CreateFolders(files.cost->Parent());
    std::vector<float> costs(maps.min_cost.begin(), maps.min_cost.end());
    costs.insert(costs.end(), maps.second_cost.begin(), maps.second_cost.end());
    WriteMap(*files.cost, {maps.depth.Width(), maps.depth.Height(), 2}, costs);
  }
  WriteNormalMap(files.normal, maps.normal);
  WriteDepthMap(files.depth, maps.depth);
}

// The passes over all images: the photometric one (index 0) and the geometric
// ones.
class StereoPasses {
 public:
  StereoPasses(const Workspace& workspace, const StereoOptions& options)
      : workspace_(workspace),
        num_geometric_(options.geom_consistency ? options.num_geometric_passes
                                                : 0) {}

  int NumPasses() const { return 1 + num_geometric_; }

  StereoMapFiles Files(int pass, int image) const {
    if (pass > 0 && pass + 1 < NumPasses()) {
      const std::string key = workspace_.Model().images[image].name;
      const ContainedPath folder = FolderOf(pass);
      return {folder / "depth" / (key + ".bin"),
              folder / "normal" / (key + ".bin"),
              std::nullopt};
    }
    const MapPaths paths = workspace_.Paths(
        image, pass == 0 ? MapType::kPhotometric : MapType::kGeometric);
    return {paths.depth, paths.normal, paths.cost};
  }

  // Whether the image has all final maps of the run.
  bool IsDone(int image) const {
    return Files(0, image).Exist() && Files(NumPasses() - 1, image).Exist();
  }

  // Removes the intermediate files after the last pass.
  void RemoveFilesBetween() const {
    for (int pass = 1; pass + 1 < NumPasses(); ++pass) {
      RemoveTree(FolderOf(pass));
    }
  }

 private:
  ContainedPath FolderOf(int pass) const {
    return GetStereoFolder(workspace_) / ("pass_" + std::to_string(pass));
  }

  const Workspace& workspace_;
  const int num_geometric_;
};

// One pass over images by their indices in Problems(). Those done before and
// those without sources are skipped.
class StereoPass : public ImagePass<StereoMaps> {
 public:
  StereoPass(const Workspace& workspace,
             const StereoOptions& options,
             const StereoPasses& passes,
             int pass,
             std::vector<PipelineWorker>& workers)
      : workspace_(workspace),
        options_(options),
        passes_(passes),
        pass_(pass),
        workers_(workers),
        is_matched_(workspace.Model().images.size()) {
    for (const StereoProblem& problem : workspace.Problems()) {
      is_matched_[problem.reference] = !problem.sources.empty();
    }
  }

  // Loads the image and, after the first pass, its current maps. Maps of
  // unmatched images are older and ignored.
  std::shared_ptr<const ViewData> Load(int image) const override {
    auto view = std::make_shared<ViewData>();
    const Camera& camera = workspace_.Model().images[image].camera;
    const auto [width, height] = MapSizeOf(camera, options_.max_image_size);
    view->color = workspace_.ReadImage(image, width, height);
    view->camera = camera.Resized(width, height);
    if (pass_ > 0 && is_matched_[image]) {
      const StereoMapFiles files = passes_.Files(pass_ - 1, image);
      if (files.Exist()) {
        view->depth = ReadDepthMap(files.depth);
        view->normal = ReadNormalMap(files.normal);
      }
    }
    return view;
  }

  ImageReport Begin(size_t index) override {
    ImageReport report;
    if (Problem(index).sources.empty() ||
        passes_.Files(pass_, Problem(index).reference).Exist()) {
      report.outcome = ImageReport::Outcome::kSkipped;
    }
    return report;
  }

  std::vector<int> Views(size_t index) const override {
    std::vector<int> views = StereoSources(Problem(index), options_);
    views.push_back(Problem(index).reference);
    return views;
  }

  StereoMaps Compute(size_t index,
                     size_t worker,
                     LoadedViews* views,
                     ImageReport*) override {
    const int image = Problem(index).reference;
    // Views of each pass have other depth maps.
    const int first_key =
        pass_ * static_cast<int>(workspace_.Model().images.size());
    const UploadedSources sources = workers_[worker].UploadSources(
        StereoSources(Problem(index), options_), image, views, first_key);
    const ViewData& reference = views->Get(image);
    const DepthInterval range = StereoDepths(workspace_, image, options_);
    const uint32_t stream =
        HashImageName(workspace_.Model().images[image].name);
    Device& device = *workers_[worker].device;
    if (pass_ == 0) {
      return MatchImage(reference, sources, range, stream, options_, device);
    }
    return MatchImageGeometrically(reference,
                                   sources,
                                   range,
                                   stream,
                                   pass_ - 1,
                                   /*keeps_holes=*/workspace_.HasMask(image),
                                   options_,
                                   device);
  }

  // An interruption loses no result: on a CPU an image takes minutes.
  bool WritesAfterStop() const override { return true; }

  // Clears the maps where the image is masked and writes them.
  void Write(size_t index, StereoMaps maps, ImageReport* report) override {
    const int image = Problem(index).reference;
    const Image<uint8_t> mask =
        workspace_.ReadMask(image, {maps.depth.Width(), maps.depth.Height()});
    ClearMasked(mask, &maps.depth);
    ClearMasked(mask, &maps.normal);
    ClearMasked(mask, &maps.min_cost, kCostWithoutEvidence);
    ClearMasked(mask, &maps.second_cost, kCostWithoutEvidence);
    WriteStereoMaps(passes_.Files(pass_, image), maps);
    report->outcome = ImageReport::Outcome::kDone;
  }

 private:
  const StereoProblem& Problem(size_t index) const {
    return workspace_.Problems()[index];
  }

  const Workspace& workspace_;
  const StereoOptions& options_;
  const StereoPasses& passes_;
  const int pass_;
  std::vector<PipelineWorker>& workers_;
  std::vector<bool> is_matched_;  // By image of the sparse model.
};

// The overview of the workspace for the devices before it has maps.
WorkspaceOverview OverviewOf(const Workspace& workspace,
                             const StereoOptions& options) {
  WorkspaceOverview overview;
  for (const StereoProblem& problem : workspace.Problems()) {
    overview.max_num_sources =
        std::max(overview.max_num_sources,
                 std::min(options.num_sources,
                          static_cast<int>(problem.sources.size())));
  }
  for (const int image : workspace.ImagesInUse()) {
    const Camera& camera = workspace.Model().images[image].camera;
    const auto [width, height] = MapSizeOf(camera, options.max_image_size);
    overview.max_num_pixels =
        std::max(overview.max_num_pixels, int64_t{width} * height);
    overview.max_num_image_pixels = std::max(
        overview.max_num_image_pixels, int64_t{camera.width} * camera.height);
    CheckPhotoFile(workspace.ImagePath(image));
    workspace.CheckMask(image, {width, height});
  }
  overview.has_maps.assign(workspace.Model().images.size(), true);
  return overview;
}

// Opens a workspace of image_undistorter with the folders for maps.
Workspace OpenForStereo(const fs::path& path, const StereoImageFiles& files) {
  if (path.empty()) {
    throw Error(ErrorCode::kBadOption,
                OptionName("workspace_path") + " is missing; give it");
  }
  RequireFoldersInside(path);
  // image_undistorter makes them, but they may have been deleted with maps.
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    if (fs::is_directory(path / "stereo")) {
      CreateFolders({path, fs::path("stereo") / folder});
    }
  }
  Workspace workspace(path, MapType::kPhotometric);
  workspace.UseMasks(files.mask_path);
  workspace.WarnOfStrayFiles();
  return workspace;
}

// For each pass, the indices in Problems() of the images to match in it, so
// that the last pass makes the listed maps as in a run on all images: every
// other pass includes the sources of the images of the next one.
std::vector<std::vector<size_t>> FindImagesOfPasses(
    const Workspace& workspace,
    const StereoOptions& options,
    int num_passes,
    const std::vector<bool>& is_listed) {
  const std::vector<StereoProblem>& problems = workspace.Problems();
  std::vector<std::optional<size_t>> index_of(workspace.Model().images.size());
  for (size_t i = 0; i < problems.size(); ++i) {
    index_of[problems[i].reference] = i;
  }
  std::vector<std::vector<size_t>> images(static_cast<size_t>(num_passes));
  std::vector<bool> is_needed = is_listed;
  for (size_t pass = images.size(); pass-- > 0;) {
    for (size_t i = 0; i < problems.size(); ++i) {
      if (is_needed[i]) {
        images[pass].push_back(i);
      }
    }
    for (const size_t i : images[pass]) {
      for (const int source : StereoSources(problems[i], options)) {
        if (index_of[source]) {
          is_needed[*index_of[source]] = true;
        }
      }
    }
  }
  return images;
}

// Runs all passes on their images and adds the images skipped in the last one
// to the summary.
void RunPasses(const Workspace& workspace,
               const StereoOptions& options,
               const StereoPasses& passes,
               const std::vector<std::vector<size_t>>& images,
               size_t max_num_views,
               PipelineDevices& devices,
               Progress& progress,
               StereoSummary* summary) {
  for (int pass = 0; pass < passes.NumPasses(); ++pass) {
    const std::string name =
        std::to_string(pass + 1) + " of " + std::to_string(passes.NumPasses());
    StereoPass stereo_pass(workspace, options, passes, pass, devices.workers);
    PipelineOutcome outcome = ImagePipeline<StereoMaps>(stereo_pass,
                                                        images[pass],
                                                        "Pass " + name + ":",
                                                        devices.at_work,
                                                        max_num_views,
                                                        progress)
                                  .Run();
    outcome.RethrowFailure();
    if (!outcome.IsComplete()) {
      throw Error(ErrorCode::kInterrupted,
                  "interrupted in pass " + name +
                      "; run the same command again to go on");
    }
    const auto num_skipped = std::ranges::count(
        outcome.reports, ImageReport::Outcome::kSkipped, &ImageReport::outcome);
    summary->num_skipped = static_cast<int>(num_skipped) -
                           static_cast<int>(summary->without_sources.size());
  }
}

}  // namespace

StereoSummary MatchWorkspace(const std::filesystem::path& workspace_path,
                             const DeviceOptions& device_options,
                             const StereoOptions& options,
                             bool overwrite,
                             Progress& progress,
                             const StereoImageFiles& files) {
  device_options.Check();
  options.Check();
  const Stopwatch stopwatch;
  const std::jthread preparing_gpus = BeginPreparingGpus(device_options);
  const Workspace workspace = OpenForStereo(workspace_path, files);
  const WorkspaceLock lock(workspace.Root());
  const std::vector<bool> is_listed =
      FindListedImages(workspace, files.image_list_path);
  const WorkspaceOverview overview = OverviewOf(workspace, options);
  const StereoPasses passes(workspace, options);
  const std::vector<std::vector<size_t>> images =
      FindImagesOfPasses(workspace, options, passes.NumPasses(), is_listed);
  if (overview.max_num_sources == 0) {
    throw Error::File(
        ErrorCode::kNotFound,
        (workspace.Root() / "stereo" / "patch-match.cfg").string(),
        "names no image with sources",
        "an image needs others that share sparse points with it");
  }
  PipelineDevices devices =
      OpenPipelineDevices(device_options,
                          PlanStereo(overview),
                          static_cast<int>(images.front().size()));
  ClaimMaps(workspace, options, overwrite, is_listed);
  StereoSummary summary;
  summary.workspace_path = workspace.Root();
  summary.type =
      options.geom_consistency ? MapType::kGeometric : MapType::kPhotometric;
  summary.device = devices.description;
  summary.num_images = static_cast<int>(images.back().size());
  summary.num_masks =
      workspace.CountMasks(workspace.ReferencesOf(images.back()));
  bool is_done = true;
  for (const size_t index : images.back()) {
    const StereoProblem& problem = workspace.Problems()[index];
    if (problem.sources.empty()) {
      summary.without_sources.push_back(
          {workspace.Model().images[problem.reference].name,
           problem.without_sources});
    } else {
      is_done = is_done && passes.IsDone(problem.reference);
    }
  }
  summary.num_skipped =
      summary.num_images - static_cast<int>(summary.without_sources.size());
  // Otherwise the intermediate files are gone and need not be made again.
  if (!is_done) {
    for (const StereoProblem& problem : workspace.Problems()) {
      for (const MapType type : kMapTypes) {
        RequireUnrefined(workspace.Paths(problem.reference, type));
      }
    }
    RunPasses(workspace,
              options,
              passes,
              images,
              devices.at_work.MaxNumViews(overview.max_num_pixels),
              devices,
              progress,
              &summary);
  }
  passes.RemoveFilesBetween();
  summary.peak_gpu_memory = PeakGpuMemory(devices);
  summary.wall_seconds = stopwatch.Seconds();
  return summary;
}

}  // namespace tsar
