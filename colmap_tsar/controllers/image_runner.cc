// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/image_runner.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/controllers/load_view.h"
#include "colmap_tsar/pipeline/refine_option_list.h"
#include "colmap_tsar/store/write_back.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <iterator>
#include <optional>
#include <utility>

namespace tsar {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

int64_t CountDepths(const Image<float>& depth) {
  return std::count_if(
      depth.begin(), depth.end(), [](float z) { return z > 0.f; });
}

// Adds what the maps tell to the image's counts.
void CountPixels(const RefinedMaps& maps,
                 std::map<std::string, int64_t>* counts) {
  std::array<int64_t, 256> histogram = {};
  for (const uint8_t provenance : maps.provenance) {
    ++histogram[provenance];
  }
  const auto from = [&](Provenance provenance) {
    return histogram[static_cast<size_t>(provenance)];
  };
  (*counts)["pixels"] = static_cast<int64_t>(maps.depth.NumPixels());
  (*counts)["depth_after"] = CountDepths(maps.depth);
  (*counts)["measured"] = from(Provenance::kMeasured);
  (*counts)["superpixel_plane"] = from(Provenance::kSuperpixelPlane);
  (*counts)["interpolated"] = from(Provenance::kInterpolated);
  (*counts)["region_plane"] = from(Provenance::kRegionPlane);
  (*counts)["other_views"] = from(Provenance::kOtherViews);
}

void Add(const std::map<std::string, double>& seconds,
         std::map<std::string, double>* sums) {
  for (const auto& [stage, value] : seconds) {
    (*sums)[stage] += value;
  }
}

// The same error, with the image and the device that it concerns.
Error WithPlace(const Error& error,
                const std::string& image,
                const std::string& device) {
  return Error(error.Code(), image + " on " + device + ": " + error.what());
}

}  // namespace

uint32_t HashImageName(const std::string& name) {
  uint32_t hash = 2166136261u;
  for (const char character : name) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 16777619u;
  }
  return hash;
}

ImageRunner::ImageRunner(const Workspace& workspace,
                         std::vector<bool> has_maps,
                         const RefineOptions& options,
                         std::vector<RefineWorker>& workers,
                         InputFingerprints& inputs,
                         EvidenceStore* evidence,
                         bool finds_scenes_ahead,
                         RefineObserver* observer)
    : workspace_(workspace),
      has_maps_(std::move(has_maps)),
      options_(options),
      options_hash_(HashRefineOptions(options)),
      workers_(workers),
      inputs_(inputs),
      evidence_(evidence),
      finds_scenes_ahead_(finds_scenes_ahead),
      observer_(observer),
      is_done_flags_(workspace.Problems().size()),
      is_done_(workspace.Problems().size()),
      served_(workspace.Model().images.size()),
      scenes_(workspace.Problems().size()),
      seconds_(workspace.Problems().size()),
      file_mutexes_(workspace.Model().images.size()) {
  for (size_t index = 0; index < NumImages(); ++index) {
    if (CanCompute(index)) {
      for (const int view : SourcesAndReference(index)) {
        served_[static_cast<size_t>(view)].push_back(index);
      }
    }
  }
}

ViewCache::View ImageRunner::Load(int image) {
  const std::lock_guard<std::mutex> lock(
      file_mutexes_[static_cast<size_t>(image)]);
  return std::make_shared<const ViewData>(LoadView(workspace_, image));
}

ImageReport ImageRunner::Begin(size_t index) {
  const StereoProblem& problem = Problem(index);
  const int image = problem.reference;
  const std::string type = ToString(workspace_.Type());
  // Before its maps are changed, for those whose source it is.
  inputs_.OfView(image);
  ImageReport report;
  report.seconds = seconds_[index];
  if (!HasMaps(image)) {
    Keep(image,
         "it has no " + type + " maps; run patch_match_stereo for this image",
         &report);
  } else if (problem.sources.empty()) {
    Keep(image, "no other image shares enough of its sparse points", &report);
  } else if (Sources(problem).empty()) {
    Keep(image, "none of its source images has " + type + " maps", &report);
  } else if (HasBeenRefined(index)) {
    report.outcome = ImageReport::Outcome::kSkipped;
  } else if (!evidence_) {
    WarnOfChanges(index);
  }
  return report;
}

std::vector<int> ImageRunner::Views(size_t index) const {
  return evidence_ ? std::vector<int>{Reference(index)}
                   : SourcesAndReference(index);
}

std::vector<int> ImageRunner::SourcesAndReference(size_t index) const {
  std::vector<int> views = Sources(Problem(index));
  views.push_back(Problem(index).reference);
  return views;
}

bool ImageRunner::CanCompute(size_t index) const {
  return HasMaps(Reference(index)) && !Sources(Problem(index)).empty();
}

bool ImageRunner::IsNeeded(size_t index) {
  const std::vector<size_t>& served =
      served_[static_cast<size_t>(Reference(index))];
  return std::any_of(served.begin(), served.end(), [&](size_t other) {
    return !HasBeenRefined(other);
  });
}

void ImageRunner::Prepare(size_t index, const ViewCache::Lease& views) {
  const int image = Reference(index);
  if (!evidence_ || !finds_scenes_ahead_ || !HasDepth(views.Get(image).depth)) {
    return;
  }
  try {
    scenes_[index] = FindSceneOf(index, *Device::CreateCpu(1));
  } catch (const Error& error) {
    throw WithPlace(error, Name(image), "the CPU");
  }
}

RefineResult ImageRunner::Compute(size_t index,
                                  size_t worker_index,
                                  ViewCache::Lease* views,
                                  ImageReport* report) {
  const StereoProblem& problem = Problem(index);
  RefineWorker& worker = workers_[worker_index];
  const ViewData& reference = views->Get(problem.reference);
  report->counts["not_finite"] = reference.num_not_finite;
  RefineResult result;
  if (!HasDepth(reference.depth)) {
    result.reason_to_keep = "its depth map holds no valid depth";
    return result;
  }
  report->num_sources_without_maps =
      static_cast<int>(problem.sources.size() - Sources(problem).size());
  const std::unique_ptr<StageObserver> observer =
      ObserverOf(problem.reference, reference);
  try {
    if (evidence_) {
      std::unique_ptr<Scene> scene = std::move(scenes_[index]);
      if (!scene) {
        scene = FindSceneOf(index, *worker.device);
      }
      result = ComposeImage(reference,
                            scene->views,
                            scene->found,
                            options_,
                            *worker.device,
                            observer.get());
    } else {
      result = WithSources(index, worker, views, [&](auto sources) {
        return RefineImage(reference,
                           std::move(sources),
                           HashImageName(Name(problem.reference)),
                           options_,
                           *worker.device,
                           observer.get());
      });
    }
  } catch (const Error& error) {
    throw WithPlace(error, Name(problem.reference), worker.name);
  }
  if (result.reason_to_keep.empty()) {
    report->counts["depth_before"] = reference.num_depths_to_refine;
  }
  return result;
}

RefineResult ImageRunner::Observe(size_t index,
                                  size_t worker_index,
                                  ViewCache::Lease* views) {
  const int image = Reference(index);
  RefineWorker& worker = workers_[worker_index];
  const ViewData& reference = views->Get(image);
  if (!HasDepth(reference.depth)) {
    return {};
  }
  const std::unique_ptr<StageObserver> observer = ObserverOf(image, reference);
  try {
    return WithSources(index, worker, views, [&](auto sources) {
      return MeasureImage(reference,
                          std::move(sources),
                          HashImageName(Name(image)),
                          options_,
                          *worker.device,
                          observer.get());
    });
  } catch (const Error& error) {
    throw WithPlace(error, Name(image), worker.name);
  }
}

void ImageRunner::MakeEvidenceOf(size_t index, RefineResult* result) const {
  try {
    MakeEvidence(options_, *Device::CreateCpu(1), result);
  } catch (const Error& error) {
    throw WithPlace(error, Name(Reference(index)), "the CPU");
  }
}

void ImageRunner::AddSeconds(size_t index,
                             const std::map<std::string, double>& seconds) {
  Add(seconds, &seconds_[index]);
}

template <typename Function>
RefineResult ImageRunner::WithSources(size_t index,
                                      RefineWorker& worker,
                                      ViewCache::Lease* views,
                                      const Function& function) {
  const StereoProblem& problem = Problem(index);
  Device& device = *worker.device;
  const Clock::time_point start = Clock::now();
  // Nothing reads the sources before DeviceViews has them, which waits for the
  // device before it lets go of them, also where a stage fails.
  std::vector<DeviceViewCache::View> sources;
  for (const int source : Sources(problem)) {
    sources.push_back(worker.views->Get(source, views->Get(source), device));
    if (source != problem.reference) {
      views->Release(source);
    }
  }
  const double upload_seconds = SecondsSince(start);
  RefineResult result = function(std::move(sources));
  result.seconds["upload"] += upload_seconds;
  return result;
}

std::unique_ptr<ImageRunner::Scene> ImageRunner::FindSceneOf(size_t index,
                                                             Device& device) {
  const StereoProblem& problem = Problem(index);
  auto scene = std::make_unique<Scene>();
  scene->own = evidence_->ReadAll(problem.reference);
  scene->views = {Observed(problem.reference, scene->own)};
  for (const int source : Sources(problem)) {
    if (source == problem.reference) {
      continue;
    }
    if (EvidenceStore::Evidence evidence = evidence_->Get(source)) {
      scene->views.push_back(Observed(source, *evidence));
      scene->others.push_back(std::move(evidence));
    }
  }
  scene->found = FindScene(scene->views, options_, device);
  return scene;
}

ObservedView ImageRunner::Observed(int image,
                                   const ViewEvidence& evidence) const {
  return {&evidence,
          workspace_.Model().images[static_cast<size_t>(image)].camera.Resized(
              evidence.width, evidence.height)};
}

void ImageRunner::Write(size_t index,
                        RefineResult result,
                        ImageReport* report) {
  const int image = Problem(index).reference;
  if (!result.reason_to_keep.empty()) {
    Keep(image, result.reason_to_keep, report);
    return;
  }
  CountPixels(result.maps, &report->counts);
  Add(result.seconds, &report->seconds);
  ImageRecord record;
  record.options_hash = options_hash_;
  record.inputs = inputs_.OfResult(image);
  record.counts = report->counts;
  record.seconds = report->seconds;
  const Clock::time_point start = Clock::now();
  WriteBack write_back(workspace_, image, std::move(record));
  write_back.PrepareFiles(result.maps);
  {
    const std::lock_guard<std::mutex> lock(
        file_mutexes_[static_cast<size_t>(image)]);
    write_back.Commit();
  }
  report->seconds["write"] = SecondsSince(start);
  report->outcome = ImageReport::Outcome::kRefined;
}

void ImageRunner::Keep(int image,
                       const std::string& reason,
                       ImageReport* report) {
  report->outcome = ImageReport::Outcome::kKept;
  report->reason = reason;
  ImageRecord record;
  record.options_hash = options_hash_;
  record.note = reason;
  record.counts = report->counts;
  const std::lock_guard<std::mutex> lock(
      file_mutexes_[static_cast<size_t>(image)]);
  KeepImage(workspace_, image, std::move(record));
}

std::vector<int> ImageRunner::Sources(const StereoProblem& problem) const {
  std::vector<int> sources;
  std::copy_if(problem.sources.begin(),
               problem.sources.end(),
               std::back_inserter(sources),
               [&](int source) { return HasMaps(source); });
  return sources;
}

bool ImageRunner::HasMaps(int image) const {
  return has_maps_[static_cast<size_t>(image)];
}

bool ImageRunner::HasBeenRefined(size_t index) {
  std::call_once(is_done_flags_[index], [&] {
    const int image = Reference(index);
    // Before anything of it is read, also where nothing is reused.
    const InputState inputs = inputs_.OfResult(image);
    is_done_[index] =
        ReusesResults() && IsDone(workspace_, image, options_hash_, inputs);
  });
  return is_done_[index] != 0;
}

void ImageRunner::WarnOfChanges(size_t index) {
  if (HasBeenRefined(index) || !ReusesResults()) {
    return;
  }
  const int image = Reference(index);
  const std::optional<ImageRecord> record =
      ReadRecord(workspace_.Paths(image, workspace_.Type()).record);
  if (!record || record->status != ImageStatus::kDone ||
      record->options_hash != options_hash_) {
    return;
  }
  const std::string reason =
      record->inputs.empty() || record->version != TSAR_VERSION
          ? "it was refined by another version"
          : inputs_.ChangesOfResult(image, record->inputs);
  if (!reason.empty()) {
    Warn(Name(image) + ": refined again, since " + reason);
  }
}

const std::string& ImageRunner::Name(int image) const {
  return workspace_.Model().images[static_cast<size_t>(image)].name;
}

std::unique_ptr<StageObserver> ImageRunner::ObserverOf(
    int image, const ViewData& view) const {
  return observer_ ? observer_->Observe(Name(image), view.depth) : nullptr;
}

}  // namespace tsar
