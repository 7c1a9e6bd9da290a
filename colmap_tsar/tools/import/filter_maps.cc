// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/filter_maps.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/run/gpu_workers.h"
#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/run/pipeline_devices.h"
#include "colmap_tsar/run/workspace_check.h"
#include "colmap_tsar/tools/stereo/stereo_image.h"
#include "colmap_tsar/tools/stereo/stereo_inputs.h"

#include <memory>
#include <thread>
#include <utility>
#include <vector>

namespace tsar {
namespace {

// With COLMAP's angle between the rays: less was measured for the maps of
// tsar_stereo alone, which chance and priors have not filled.
StereoOptions OptionsOfFilter() {
  StereoOptions options;
  options.filter_min_triangulation_angle = 3.0;
  return options;
}

class FilterPass : public ImagePass<StereoMaps> {
 public:
  FilterPass(const Workspace& workspace,
             const WorkspaceOverview& overview,
             std::vector<PipelineWorker>& workers)
      : workspace_(workspace), overview_(overview), workers_(workers) {}

  ImageReport Begin(size_t /*index*/) override { return {}; }

  std::vector<int> Views(size_t index) const override {
    std::vector<int> views = Sources(index);
    views.push_back(Problem(index).reference);
    return views;
  }

  std::shared_ptr<const ViewData> Load(int image) const override {
    return std::make_shared<const ViewData>(LoadView(workspace_, image));
  }

  StereoMaps Compute(size_t index,
                     size_t worker,
                     LoadedViews* views,
                     ImageReport* /*report*/) override {
    const int image = Problem(index).reference;
    const UploadedSources sources =
        workers_[worker].UploadSources(Sources(index), image, views);
    return FilterImage(
        views->Get(image), sources, options_, *workers_[worker].device);
  }

  void Write(size_t index, StereoMaps maps, ImageReport* report) override {
    const MapPaths paths =
        workspace_.Paths(Problem(index).reference, MapType::kGeometric);
    WriteDepthMap(paths.depth, maps.depth);
    WriteNormalMap(paths.normal, maps.normal);
    report->outcome = ImageReport::Outcome::kDone;
  }

 private:
  const StereoProblem& Problem(size_t index) const {
    return workspace_.Problems()[index];
  }

  // Those with maps; without a depth map none confirms anything.
  std::vector<int> Sources(size_t index) const {
    std::vector<int> sources = StereoSources(Problem(index), options_);
    std::erase_if(sources,
                  [&](int source) { return !overview_.has_maps[source]; });
    return sources;
  }

  const Workspace& workspace_;
  const WorkspaceOverview& overview_;
  std::vector<PipelineWorker>& workers_;
  const StereoOptions options_ = OptionsOfFilter();
};

}  // namespace

void FilterMaps(const Workspace& workspace,
                const DeviceOptions& device_options,
                Progress& progress) {
  const std::jthread preparing_gpus = BeginPreparingGpus(device_options);
  const WorkspaceOverview overview =
      CheckWorkspace(workspace, device_options.num_threads);
  std::vector<size_t> images;
  for (size_t i = 0; i < workspace.Problems().size(); ++i) {
    if (overview.has_maps[workspace.Problems()[i].reference]) {
      images.push_back(i);
    }
  }
  PipelineDevices devices = OpenPipelineDevices(
      device_options, PlanStereo(overview), static_cast<int>(images.size()));
  FilterPass pass(workspace, overview, devices.workers);
  const PipelineOutcome outcome =
      ImagePipeline<StereoMaps>(
          pass,
          std::move(images),
          "Filtering:",
          devices.at_work,
          devices.at_work.MaxNumViews(overview.max_num_pixels),
          progress)
          .Run();
  outcome.RethrowFailure();
  if (!outcome.IsComplete()) {
    throw Error(ErrorCode::kInterrupted, "interrupted; nothing was imported");
  }
}

}  // namespace tsar
