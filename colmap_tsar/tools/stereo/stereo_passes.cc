// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_passes.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/tools/stereo/stereo_inputs.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

namespace tsar {

namespace fs = std::filesystem;

bool StereoMapFiles::Exist() const {
  return fs::exists(depth) && fs::exists(normal) &&
         (!cost || fs::exists(*cost));
}

void WriteStereoMaps(const StereoMapFiles& files, const StereoMaps& maps) {
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

StereoPasses::StereoPasses(const Workspace& workspace,
                           const StereoOptions& options)
    : workspace_(workspace),
      num_geometric_(options.geom_consistency ? options.num_geometric_passes
                                              : 0) {}

StereoMapFiles StereoPasses::Files(int pass, int image) const {
  if (pass > 0 && pass + 1 < NumPasses()) {
    const std::string key = workspace_.Model().images[image].name;
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

bool StereoPasses::IsDone(int image) const {
  return Files(0, image).Exist() && Files(NumPasses() - 1, image).Exist();
}

void StereoPasses::RemoveFilesBetween() const {
  for (int pass = 1; pass + 1 < NumPasses(); ++pass) {
    RemoveTree(GetStereoFolder(workspace_) / ("pass_" + std::to_string(pass)));
  }
}

StereoTask::StereoTask(const Workspace& workspace,
                       const StereoOptions& options,
                       const StereoPasses& passes,
                       int pass,
                       std::vector<RefineWorker>& workers)
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

std::shared_ptr<const ViewData> StereoTask::Load(int image) const {
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

ImageReport StereoTask::Begin(size_t index) {
  ImageReport report;
  if (Problem(index).sources.empty() ||
      passes_.Files(pass_, Problem(index).reference).Exist()) {
    report.outcome = ImageReport::Outcome::kSkipped;
  }
  return report;
}

std::vector<int> StereoTask::Views(size_t index) const {
  std::vector<int> views = StereoSources(Problem(index), options_);
  views.push_back(Problem(index).reference);
  return views;
}

StereoMaps StereoTask::Compute(size_t index,
                               size_t worker,
                               LoadedViews* views,
                               ImageReport*) {
  const int image = Problem(index).reference;
  std::vector<const ViewData*> sources;
  for (const int source : StereoSources(Problem(index), options_)) {
    sources.push_back(&views->Get(source));
  }
  const ViewData& reference = views->Get(image);
  const DepthInterval range = StereoDepths(workspace_, image, options_);
  const uint32_t stream = HashImageName(workspace_.Model().images[image].name);
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

void StereoTask::Write(size_t index, StereoMaps maps, ImageReport* report) {
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

}  // namespace tsar
