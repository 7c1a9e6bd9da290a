// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_task.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/tools/stereo/fill_under_prior.h"
#include "colmap_tsar/tools/stereo/stereo_inputs.h"

#include <memory>

namespace tsar {

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

ViewCache::View StereoTask::Load(int image) const {
  auto view = std::make_shared<ViewData>();
  const Camera& camera = workspace_.Model().images[image].camera;
  const auto [width, height] = MapSizeOf(camera, options_.max_image_size);
  view->color = workspace_.ReadImage(image, width, height);
  view->camera = camera.Resized(width, height);
  if (pass_ > 0 && is_matched_[image]) {
    const StereoMapFiles files = passes_.Files(pass_ - 1, image);
    if (files.Exist()) {
      ReadStereoMaps(files, passes_.IsUnderPrior(pass_), view.get());
    }
  }
  if (passes_.Fills(pass_) && workspace_.Priors().HasPrior(image)) {
    view->prior = LoadPrior(
        workspace_, image, workspace_.ReadMask(image, {width, height}));
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
                               ViewCache::Lease* views,
                               ImageReport* report) {
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
  if (passes_.IsUnderPrior(pass_)) {
    return MatchUnderPrior(reference, sources, range, stream, options_, device);
  }
  StereoMaps maps =
      MatchImageGeometrically(reference,
                              sources,
                              range,
                              stream,
                              pass_ - 1,
                              /*keeps_holes=*/workspace_.HasMask(image),
                              options_,
                              device);
  report->prior = maps.prior;
  return maps;
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
