// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_passes.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/compose/compose_image.h"
#include "colmap_tsar/compose/refine_image.h"
#include "colmap_tsar/device/device.h"
#include "colmap_tsar/io/photo.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/run/store/write_back.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace tsar {
namespace {

SceneModel ReadCurrentModel(const RefineRun& run) {
  const ContainedPath path = GetSceneModelPath(run.workspace.Root());
  if (!run.HasCurrentPlanes()) {
    throw Error::File(
        ErrorCode::kNotFound,
        path.string(),
        "holds no planes that were found in these views with these options",
        "run " + OptionName("pass") + " model first");
  }
  return ReadSceneModel(path);
}

// The model's labels of the image. Throws kMismatch where none fit.
const ViewLabels& LabelsOf(const RefineRun& run,
                           const SceneModel& model,
                           int image,
                           const ViewEvidence& evidence) {
  const auto labels = model.views.find(image);
  if (labels == model.views.end() ||
      labels->second.planes.size() != evidence.weights.size()) {
    throw Error::File(ErrorCode::kMismatch,
                      GetSceneModelPath(run.workspace.Root()).string(),
                      "the planes of the scene were not found in this image as "
                      "it was observed",
                      "remove the file and run the same command again");
  }
  return labels->second;
}

// Reads the evidence of an image and its neighbors, and finds their scene.
std::unique_ptr<ImageScene> FindImageScene(const RefineRun& run,
                                           const SceneModel& model,
                                           size_t index,
                                           Device& device) {
  const int reference = run.selection.Reference(index);
  auto scene = std::make_unique<ImageScene>();
  std::vector<const ViewLabels*> labels;
  const auto add = [&](int image, const ViewEvidence& evidence) {
    scene->views.push_back(
        MakeObservedView(evidence, run.workspace.CameraOf(image)));
    labels.push_back(&LabelsOf(run, model, image, evidence));
  };
  scene->own = run.evidence.ReadAll(reference);
  add(reference, scene->own);
  for (const int source : run.selection.Sources(index)) {
    if (source == reference) {
      continue;
    }
    if (EvidenceStore::Evidence evidence = run.evidence.Get(source)) {
      add(source, *evidence);
      scene->others.push_back(std::move(evidence));
    }
  }
  scene->found = FindScene(scene->views, model.planes, labels, device);
  scene->found.cylinders =
      ToCameraCylinders(model.cylinders, scene->views[0].camera);
  return scene;
}

void AddSeconds(const StageSeconds& seconds, StageSeconds* sums) {
  for (const auto& [stage, value] : seconds) {
    (*sums)[stage] += value;
  }
}

// Returns what work() returns. An error gets the names of image and device.
template <typename Work>
auto NamePlaceOfErrors(const RefineRun& run,
                       size_t index,
                       const std::string& device,
                       const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw Error(
        error.Code(),
        run.selection.Name(index) + " on " + device + ": " + error.what());
  }
}

// RefineImage, or ObserveImage.
using SingleViewStages =
    RefineResult (*)(const ViewData& reference,
                     std::vector<UploadedViews::Pointer> sources,
                     uint32_t image_id,
                     const RefineOptions& options,
                     Device& device);

// Runs the stages with the sources in the worker's memory.
RefineResult RunSingleView(const RefineRun& run,
                           size_t index,
                           const PipelineWorker& worker,
                           LoadedViews* views,
                           SingleViewStages stages) {
  const int image = run.selection.Reference(index);
  const ViewData& reference = views->Get(image);
  return NamePlaceOfErrors(run, index, worker.name, [&] {
    const Stopwatch uploading;
    // Nothing reads the sources before DeviceViews owns them, which waits for
    // the device before it releases them, also where a stage fails.
    std::vector<UploadedViews::Pointer> sources =
        worker.UploadSources(run.selection.Sources(index), image, views);
    const double upload_seconds = uploading.Seconds();
    RefineResult result = stages(reference,
                                 std::move(sources),
                                 HashImageName(run.selection.Name(index)),
                                 run.refine_options,
                                 *worker.device);
    result.seconds["upload"] += upload_seconds;
    return result;
  });
}

// Empty maps of the size of this map.
RefinedMaps EmptyMaps(const Image<float>& depth, const RefineOptions& options) {
  const int width = depth.Width();
  const int height = depth.Height();
  RefinedMaps maps{Image<float>(width, height),
                   Image<Vec3f>(width, height),
                   Image<uint8_t>(width, height),
                   Image<uint8_t>(width, height)};
  if (NeedsEvidence(options)) {
    maps.planes = Image<uint16_t>(width, height);
  }
  if (options.sigma_maps) {
    maps.sigma = Image<uint16_t>(width, height);
  }
  return maps;
}

// Adds the pixel counts of the maps to the image's counts.
void CountPixels(const RefinedMaps& maps,
                 std::map<std::string, int64_t>* counts) {
  std::array<int64_t, 256> histogram = {};
  for (const uint8_t provenance : maps.provenance) {
    ++histogram[provenance];
  }
  const auto num_pixels = static_cast<int64_t>(maps.provenance.NumPixels());
  (*counts)["pixels"] = num_pixels;
  (*counts)["depth_after"] =
      num_pixels - histogram[static_cast<size_t>(Provenance::kNone)];
  for (size_t provenance = 1; provenance < kProvenanceNames.size();
       ++provenance) {
    std::string name = kProvenanceNames[provenance];
    std::ranges::replace(name, ' ', '_');
    (*counts)[name] = histogram[provenance];
  }
}

}  // namespace

ObservePass::ObservePass(const RefineRun& run,
                         std::vector<StageSeconds>& seconds)
    : run_(run), seconds_(seconds), has_model_(run.HasCurrentPlanes()) {}

std::shared_ptr<const ViewData> ObservePass::Load(int image) const {
  return std::make_shared<const ViewData>(
      LoadReducedView(run_.workspace, image));
}

ImageReport ObservePass::Begin(size_t index) {
  ImageReport report;
  // The last pass finds out and reports why an image cannot be refined.
  const int image = run_.selection.Reference(index);
  if (!(has_model_ ? run_.selection.IsNeeded(index)
                   : run_.selection.IsAnyNeeded()) ||
      run_.evidence.IsObserved(image)) {
    report.outcome = ImageReport::Outcome::kSkipped;
  } else if (!run_.selection.CanRefine(index)) {
    run_.evidence.WriteNothing(image);
    report.outcome = ImageReport::Outcome::kSkipped;
  }
  return report;
}

RefineResult ObservePass::Compute(size_t index,
                                  size_t worker,
                                  LoadedViews* views,
                                  ImageReport* /*report*/) {
  if (!HasDepth(views->Get(run_.selection.Reference(index)).depth)) {
    return {};
  }
  return RunSingleView(
      run_, index, run_.devices.workers[worker], views, ObserveImage);
}

void ObservePass::Write(size_t index,
                        RefineResult result,
                        ImageReport* report) {
  if (result.measured) {
    NamePlaceOfErrors(run_, index, "the CPU", [&] {
      MakeEvidence(run_.refine_options, *Device::CreateCpu(1), &result);
    });
    run_.evidence.Write(run_.selection.Reference(index), *result.evidence);
  } else {
    run_.evidence.WriteNothing(run_.selection.Reference(index));
  }
  AddSeconds(report->seconds, &seconds_[index]);
  AddSeconds(result.seconds, &seconds_[index]);
  report->outcome = ImageReport::Outcome::kDone;
}

ComposePass::ComposePass(const RefineRun& run,
                         std::vector<StageSeconds> seconds)
    : run_(run),
      seconds_(std::move(seconds)),
      record_(CurrentRecord(run.workspace, run.refine_options, run.inputs)),
      model_(run.HasScenePlanes() && run.IsAnyNeeded() ? ReadCurrentModel(run)
                                                       : SceneModel()),
      scenes_(run.selection.NumImages()) {}

std::shared_ptr<const ViewData> ComposePass::Load(int image) const {
  return std::make_shared<const ViewData>(LoadView(run_.workspace, image));
}

ImageReport ComposePass::Begin(size_t index) {
  ImageReport report = run_.selection.Begin(index);
  if (report.outcome == ImageReport::Outcome::kKept) {
    Keep(index, &report);
  } else if (report.outcome == ImageReport::Outcome::kNotDone) {
    report.seconds = seconds_[index];
  }
  return report;
}

std::vector<int> ComposePass::Views(size_t index) const {
  return run_.HasScenePlanes()
             ? std::vector<int>{run_.selection.Reference(index)}
             : run_.selection.SourcesAndReference(index);
}

void ComposePass::Prepare(size_t index) {
  if (run_.HasScenePlanes() && run_.devices.finds_scenes_ahead &&
      run_.evidence.IsCurrent(run_.selection.Reference(index))) {
    scenes_[index] = NamePlaceOfErrors(run_, index, "the CPU", [&] {
      return FindImageScene(run_, model_, index, *Device::CreateCpu(1));
    });
  }
}

RefineResult ComposePass::Compute(size_t index,
                                  size_t worker,
                                  LoadedViews* views,
                                  ImageReport* report) {
  const int image = run_.selection.Reference(index);
  const ViewData& reference = views->Get(image);
  report->counts["not_finite"] = reference.num_not_finite;
  if (!run_.workspace.HasMask(image) && HasBlackBorder(reference.color)) {
    report->counts[kBlackBorders] = 1;
  }
  RefineResult result;
  if (!HasDepth(reference.depth)) {
    if (IsMaskedAway(run_.workspace, image)) {
      // Masked depths are not to stay.
      result.maps = EmptyMaps(reference.depth, run_.refine_options);
      report->counts[kMaskedAway] = 1;
    } else {
      result.reason_to_keep =
          "its maps hold no valid depth with a normal, or none where the image "
          "has texture";
    }
    return result;
  }
  report->num_sources_without_maps =
      static_cast<int>(run_.selection.Problem(index).sources.size() -
                       run_.selection.Sources(index).size());
  result =
      run_.HasScenePlanes()
          ? Compose(index, run_.devices.workers[worker], reference)
          : RunSingleView(
                run_, index, run_.devices.workers[worker], views, RefineImage);
  if (result.reason_to_keep.empty()) {
    report->counts["depth_before"] = reference.num_depths;
  }
  return result;
}

void ComposePass::Write(size_t index,
                        RefineResult result,
                        ImageReport* report) {
  if (!result.reason_to_keep.empty()) {
    report->reason = result.reason_to_keep;
    Keep(index, report);
    return;
  }
  const int image = run_.selection.Reference(index);
  AddSeconds(result.seconds, &report->seconds);
  RefinedMaps& maps = result.maps;
  ClearMaskedPixels(
      run_.workspace.ReadMask(image, {maps.depth.Width(), maps.depth.Height()}),
      &maps);
  CountPixels(maps, &report->counts);
  if (result.prior.verdict != PriorVerdict::kNone) {
    report->counts[result.prior.IsDropped() ? kPriorsDropped : kPriorsUsed] = 1;
  }
  ImageRecord record = record_;
  record.note = Describe(result.prior);
  record.counts = report->counts;
  record.seconds = report->seconds;
  const Stopwatch writing;
  WriteRefined(run_.workspace, image, maps, std::move(record));
  report->seconds["write"] = writing.Seconds();
  report->outcome = ImageReport::Outcome::kDone;
}

void ComposePass::Keep(size_t index, ImageReport* report) const {
  report->outcome = ImageReport::Outcome::kKept;
  ImageRecord record;
  record.options_hash = record_.options_hash;
  record.note = report->reason;
  record.counts = report->counts;
  KeepImage(run_.workspace, run_.selection.Reference(index), std::move(record));
}

RefineResult ComposePass::Compose(size_t index,
                                  const PipelineWorker& worker,
                                  const ViewData& reference) {
  // It may have no depth at the size at which it is judged.
  if (!run_.evidence.IsCurrent(run_.selection.Reference(index))) {
    RefineResult result;
    result.reason_to_keep = kNothingReliable;
    return result;
  }
  return NamePlaceOfErrors(run_, index, worker.name, [&] {
    std::unique_ptr<ImageScene> scene = std::move(scenes_[index]);
    if (!scene) {
      scene = FindImageScene(run_, model_, index, *worker.device);
    }
    return ComposeImage(reference,
                        scene->views,
                        scene->found,
                        run_.refine_options,
                        *worker.device);
  });
}

}  // namespace tsar
