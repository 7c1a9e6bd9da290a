// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/image_catalog.h"

#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/stopwatch.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/load_view.h"
#include "colmap_tsar/run/store/write_back.h"
#include "colmap_tsar/view/reduce_view.h"
#include "colmap_tsar/view/unmatched_depths.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <optional>
#include <utility>

namespace tsar {
namespace {

int64_t CountDepths(const Image<float>& depth) {
  return std::count_if(
      depth.begin(), depth.end(), [](float z) { return z > 0.f; });
}

// Adds the pixel counts of the maps to the image's counts.
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
  (*counts)["guessed"] = from(Provenance::kGuessed);
  (*counts)["prior"] = from(Provenance::kPrior);
}

void ClearMasked(const Image<uint8_t>& mask, RefinedMaps* maps) {
  ClearMasked(mask, &maps->depth);
  ClearMasked(mask, &maps->normal);
  ClearMasked(mask, &maps->confidence);
  ClearMasked(mask, &maps->provenance);
  ClearMasked(mask, &maps->planes);
  ClearMasked(mask, &maps->sigma);
}

}  // namespace

void AddStageSeconds(const std::map<std::string, double>& seconds,
                     std::map<std::string, double>* sums) {
  for (const auto& [stage, value] : seconds) {
    (*sums)[stage] += value;
  }
}

ImageCatalog::ImageCatalog(const Workspace& workspace,
                           std::vector<bool> has_maps,
                           std::string options_hash,
                           InputFingerprints& inputs,
                           std::string planes,
                           bool reuses_results,
                           bool distrust_unmatched)
    : workspace_(workspace),
      has_maps_(std::move(has_maps)),
      options_hash_(std::move(options_hash)),
      inputs_(inputs),
      planes_(std::move(planes)),
      used_planes_(planes_),
      reuses_results_(reuses_results),
      distrust_unmatched_(distrust_unmatched),
      is_listed_(workspace.Problems().size(), true),
      is_done_flags_(workspace.Problems().size()),
      is_done_(workspace.Problems().size()),
      index_of_(workspace.Model().images.size(), -1),
      users_(workspace.Model().images.size()),
      seconds_(workspace.Problems().size()),
      file_mutexes_(workspace.Model().images.size()) {
  for (size_t index = 0; index < NumImages(); ++index) {
    index_of_[static_cast<size_t>(Reference(index))] =
        static_cast<int64_t>(index);
    if (CanRefine(index)) {
      for (const int view : SourcesAndReference(index)) {
        users_[static_cast<size_t>(view)].push_back(index);
      }
    }
  }
}

void ImageCatalog::RefineOnly(std::vector<bool> is_listed) {
  is_listed_ = std::move(is_listed);
}

size_t ImageCatalog::NumListed() const {
  return static_cast<size_t>(
      std::count(is_listed_.begin(), is_listed_.end(), true));
}

bool ImageCatalog::IsMaskedAway(int image) const {
  return tsar::IsMaskedAway(workspace_, image);
}

const std::string& ImageCatalog::Name(int image) const {
  return workspace_.Model().images[static_cast<size_t>(image)].name;
}

bool ImageCatalog::HasMaps(int image) const {
  return has_maps_[static_cast<size_t>(image)];
}

std::vector<int> ImageCatalog::Sources(size_t index) const {
  std::vector<int> sources;
  std::copy_if(Problem(index).sources.begin(),
               Problem(index).sources.end(),
               std::back_inserter(sources),
               [&](int source) { return HasMaps(source); });
  return sources;
}

std::vector<int> ImageCatalog::SourcesAndReference(size_t index) const {
  std::vector<int> views = Sources(index);
  views.push_back(Reference(index));
  return views;
}

int ImageCatalog::NumSourcesWithoutMaps(size_t index) const {
  return static_cast<int>(Problem(index).sources.size() -
                          Sources(index).size());
}

bool ImageCatalog::CanRefine(size_t index) const {
  return HasMaps(Reference(index)) && !Sources(index).empty();
}

InputState ImageCatalog::InputsOf(int image, const std::string& planes) {
  InputState inputs = inputs_.OfResult(image);
  inputs[ImageRecord::kPlanes] = planes;
  return inputs;
}

bool ImageCatalog::HasBeenRefined(size_t index) {
  std::call_once(is_done_flags_[index], [&] {
    const int image = Reference(index);
    // Records the inputs before any is read, also where nothing is reused.
    const InputState inputs = InputsOf(image, planes_);
    is_done_[index] =
        reuses_results_ && IsDone(workspace_, image, options_hash_, inputs);
  });
  return is_done_[index] != 0;
}

bool ImageCatalog::IsToBeRefined(size_t index) {
  return IsListed(index) && CanRefine(index) && !HasBeenRefined(index);
}

bool ImageCatalog::WasRefinedOtherwise(size_t index) {
  const int image = Reference(index);
  const std::optional<ImageRecord> record =
      ReadRecord(workspace_.Paths(image, workspace_.Type()).record);
  return record && record->status == ImageStatus::kDone &&
         !IsDone(workspace_, image, options_hash_, InputsOf(image, planes_));
}

bool ImageCatalog::IsNeeded(size_t index) {
  const std::vector<size_t>& users =
      users_[static_cast<size_t>(Reference(index))];
  return std::any_of(users.begin(), users.end(), [&](size_t other) {
    return IsToBeRefined(other);
  });
}

bool ImageCatalog::IsAnyNeeded() {
  std::call_once(is_any_needed_flag_, [&] {
    for (size_t index = 0; index < NumImages() && !is_any_needed_; ++index) {
      is_any_needed_ = IsToBeRefined(index);
    }
  });
  return is_any_needed_;
}

void ImageCatalog::WarnOfChanges(size_t index) {
  if (!IsListed(index) || HasBeenRefined(index) || !reuses_results_) {
    return;
  }
  const int image = Reference(index);
  const std::optional<ImageRecord> record =
      ReadRecord(workspace_.Paths(image, workspace_.Type()).record);
  if (!record || record->status != ImageStatus::kDone ||
      record->options_hash != options_hash_) {
    return;
  }
  std::string reason = record->version != TSAR_VERSION
                           ? "it was refined by another version"
                           : inputs_.ChangesOfResult(image, record->inputs);
  if (reason.empty()) {
    reason = "some of what was written for it is missing or has changed";
  }
  Warn(Name(image) + ": refined again, since " + reason);
}

ViewCache::View ImageCatalog::Load(int image) {
  const auto view = std::make_shared<ViewData>();
  {
    const std::lock_guard<std::mutex> lock(
        file_mutexes_[static_cast<size_t>(image)]);
    *view = LoadView(workspace_, image);
  }
  const int64_t index = index_of_[static_cast<size_t>(image)];
  if (distrust_unmatched_ && index >= 0 && view->is_unfiltered) {
    DropUnmatchedDepths(static_cast<size_t>(index), view.get());
  }
  return view;
}

void ImageCatalog::DropUnmatchedDepths(size_t index, ViewData* view) {
  const std::vector<int> sources = Sources(index);
  UnmatchedDepths unmatched(*view, static_cast<int>(sources.size()));
  for (const int source : sources) {
    const ViewData other = [&] {
      // Locks one image at a time, so that two threads that load each other's
      // source do not deadlock.
      const std::lock_guard<std::mutex> lock(
          file_mutexes_[static_cast<size_t>(source)]);
      return LoadDepthAndColor(workspace_, source);
    }();
    unmatched.CompareWith(other);
  }
  unmatched.Drop(view);
}

ViewCache::View ImageCatalog::LoadReduced(int image) {
  if (distrust_unmatched_) {
    // Depths are compared with the images at the size of the maps.
    const ViewCache::View view = Load(image);
    const int factor =
        ReductionFactor(view->depth.Width(), view->depth.Height());
    return factor == 1
               ? view
               : std::make_shared<const ViewData>(ReduceView(*view, factor));
  }
  const std::lock_guard<std::mutex> lock(
      file_mutexes_[static_cast<size_t>(image)]);
  return std::make_shared<const ViewData>(LoadReducedView(workspace_, image));
}

ImageReport ImageCatalog::BeginRefining(size_t index) {
  const std::string type = ToString(workspace_.Type());
  ImageReport report;
  if (!IsListed(index)) {
    report.outcome = ImageReport::Outcome::kNotListed;
    return report;
  }
  // Records the state of the maps, for their users, before they change.
  inputs_.OfView(Reference(index));
  report.seconds = seconds_[index];
  if (!HasMaps(Reference(index))) {
    Keep(index,
         "it has no " + type + " maps; " +
             AdviceForMissing(
                 workspace_.DepthPath(Reference(index), workspace_.Type()),
                 "run patch_match_stereo for this image"),
         &report);
  } else if (Problem(index).sources.empty()) {
    Keep(index, Problem(index).without_sources, &report);
  } else if (Sources(index).empty()) {
    Keep(index, "none of its source images has " + type + " maps", &report);
  } else if (HasBeenRefined(index)) {
    report.outcome = ImageReport::Outcome::kSkipped;
    // The counts of the run that refined it.
    report.counts =
        ReadRecord(workspace_.Paths(Reference(index), workspace_.Type()).record)
            ->counts;
  }
  return report;
}

void ImageCatalog::WriteRefined(size_t index,
                                RefinedMaps maps,
                                ImageReport* report) {
  const int image = Reference(index);
  ClearMasked(
      workspace_.ReadMask(image, {maps.depth.Width(), maps.depth.Height()}),
      &maps);
  CountPixels(maps, &report->counts);
  if (report->prior.verdict != PriorVerdict::kNone) {
    report->counts[report->prior.IsDropped() ? kPriorsDropped : kPriorsUsed] =
        1;
  }
  ImageRecord record;
  record.note = Describe(report->prior);
  record.options_hash = options_hash_;
  record.inputs = InputsOf(image, used_planes_);
  record.counts = report->counts;
  record.seconds = report->seconds;
  const Stopwatch writing;
  WriteBack write_back(workspace_, image, std::move(record));
  write_back.PrepareFiles(maps);
  {
    const std::lock_guard<std::mutex> lock(
        file_mutexes_[static_cast<size_t>(image)]);
    write_back.Commit();
  }
  report->seconds["write"] = writing.Seconds();
  report->outcome = ImageReport::Outcome::kDone;
}

void ImageCatalog::Keep(size_t index,
                        const std::string& reason,
                        ImageReport* report) {
  const int image = Reference(index);
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

void ImageCatalog::AddSeconds(size_t index,
                              const std::map<std::string, double>& seconds) {
  AddStageSeconds(seconds, &seconds_[index]);
}

}  // namespace tsar
