// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_task.h"

#include "colmap_tsar/base/image_name_hash.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/compose/measure_image.h"

#include <utility>

namespace tsar {

RefineResult RefineTask::RunSingleView(size_t index,
                                       size_t worker_index,
                                       ViewCache::Lease* views,
                                       SingleViewStages stages) {
  const int image = images_.Reference(index);
  RefineWorker& worker = workers_[worker_index];
  const ViewData& reference = views->Get(image);
  const std::unique_ptr<StageObserver> observer = ObserverOf(index, reference);
  try {
    const Stopwatch uploading;
    // Nothing reads the sources before DeviceViews owns them, which waits for
    // the device before it releases them, also where a stage fails.
    std::vector<DeviceViewCache::View> sources;
    for (const int source : images_.Sources(index)) {
      sources.push_back(
          worker.views->Get(source, views->Get(source), *worker.device));
      if (source != image) {
        views->Release(source);
      }
    }
    const double upload_seconds = uploading.Seconds();
    RefineResult result = stages(reference,
                                 std::move(sources),
                                 HashImageName(images_.Name(image)),
                                 options_,
                                 *worker.device,
                                 observer.get());
    result.seconds["upload"] += upload_seconds;
    return result;
  } catch (const Error& error) {
    throw WithPlace(error, index, worker.name);
  }
}

std::unique_ptr<StageObserver> RefineTask::ObserverOf(
    size_t index, const ViewData& view) const {
  return observer_ && images_.IsListed(index)
             ? observer_->Observe(images_.Name(images_.Reference(index)),
                                  view.depth)
             : nullptr;
}

Error RefineTask::WithPlace(const Error& error,
                            size_t index,
                            const std::string& device) const {
  return Error(error.Code(),
               images_.Name(images_.Reference(index)) + " on " + device + ": " +
                   error.what());
}

RefineResult RefineMapsTask::Compute(size_t index,
                                     size_t worker,
                                     ViewCache::Lease* views,
                                     ImageReport* report) {
  const ViewData& reference = views->Get(images_.Reference(index));
  report->counts["not_finite"] = reference.num_not_finite;
  if (!HasDepth(reference.depth)) {
    RefineResult result;
    if (images_.IsMaskedAway(images_.Reference(index))) {
      // Masked depths are not to stay.
      result.maps = EmptyMaps(reference.depth);
      return result;
    }
    result.reason_to_keep =
        "its depth map holds no valid depth, or none where the image has "
        "texture";
    return result;
  }
  report->num_sources_without_maps = images_.NumSourcesWithoutMaps(index);
  RefineResult result = RefineMaps(index, worker, views);
  if (result.reason_to_keep.empty()) {
    report->counts["depth_before"] = reference.num_depths_to_refine;
  }
  return result;
}

RefinedMaps RefineMapsTask::EmptyMaps(const Image<float>& depth) const {
  const int width = depth.Width();
  const int height = depth.Height();
  RefinedMaps maps{Image<float>(width, height),
                   Image<Vec3f>(width, height),
                   Image<float>(width, height),
                   Image<uint8_t>(width, height)};
  if (NeedsEvidence(options_)) {
    maps.planes = Image<uint16_t>(width, height);
  }
  if (options_.sigma_maps) {
    maps.sigma = Image<uint16_t>(width, height);
  }
  return maps;
}

void RefineMapsTask::Write(size_t index,
                           RefineResult result,
                           ImageReport* report) {
  if (!result.reason_to_keep.empty()) {
    images_.Keep(index, result.reason_to_keep, report);
    return;
  }
  AddStageSeconds(result.seconds, &report->seconds);
  report->prior = result.prior;
  images_.WriteRefined(index, std::move(result.maps), report);
}

ImageReport ObserveTask::Begin(size_t index) {
  ImageReport report;
  if (images_.CanRefine(index)) {
    images_.WarnOfChanges(index);
  }
  // The second pass finds out and reports why an image cannot be refined.
  if (!(has_model_ ? images_.IsNeeded(index) : images_.IsAnyNeeded()) ||
      (images_.ReusesResults() &&
       evidence_.IsCurrent(images_.Reference(index))) ||
      !images_.CanRefine(index)) {
    report.outcome = ImageReport::Outcome::kSkipped;
  }
  return report;
}

RefineResult ObserveTask::Compute(size_t index,
                                  size_t worker,
                                  ViewCache::Lease* views,
                                  ImageReport* /*report*/) {
  if (!HasDepth(views->Get(images_.Reference(index)).depth)) {
    return {};
  }
  return RunSingleView(index, worker, views, &MeasureImage);
}

void ObserveTask::Write(size_t index,
                        RefineResult result,
                        ImageReport* report) {
  if (result.measured) {
    try {
      MakeEvidence(options_, *Device::CreateCpu(1), &result);
    } catch (const Error& error) {
      throw WithPlace(error, index, "the CPU");
    }
    evidence_.Write(images_.Reference(index), *result.evidence);
  }
  images_.AddSeconds(index, report->seconds);
  images_.AddSeconds(index, result.seconds);
  report->outcome = ImageReport::Outcome::kDone;
}

ImageReport SingleViewTask::Begin(size_t index) {
  ImageReport report = RefineMapsTask::Begin(index);
  if (report.outcome == ImageReport::Outcome::kNotDone) {
    images_.WarnOfChanges(index);
  }
  return report;
}

RefineResult SingleViewTask::RefineMaps(size_t index,
                                        size_t worker,
                                        ViewCache::Lease* views) {
  return RunSingleView(index, worker, views, &RefineImage);
}

}  // namespace tsar
