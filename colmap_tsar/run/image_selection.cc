// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/image_selection.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/run/evidence_store.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/run/store/write_back.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

namespace tsar {

std::vector<bool> FindListedImages(const Workspace& workspace,
                                   const std::filesystem::path& list) {
  const std::vector<StereoProblem>& problems = workspace.Problems();
  if (list.empty()) {
    return std::vector<bool>(problems.size(), true);
  }
  std::vector<bool> is_listed(problems.size());
  for (const ListedImage& listed :
       ReadImageList(list, workspace.Model(), OptionName("image_list_path"))) {
    const auto problem =
        std::ranges::find(problems, listed.image, &StereoProblem::reference);
    if (problem == problems.end()) {
      throw Error::File(ErrorCode::kMismatch,
                        list.string(),
                        "line " + std::to_string(listed.line) + " names " +
                            workspace.Name(listed.image) +
                            ", which stereo/patch-match.cfg gives no sources",
                        "correct the line");
    }
    is_listed[problem - problems.begin()] = true;
  }
  return is_listed;
}

ImageRecord CurrentRecord(const Workspace& workspace,
                          const RefineOptions& options,
                          const InputFingerprints& inputs) {
  ImageRecord record;
  record.options_hash = HashRefineOptions(options);
  record.inputs = inputs.OfRun();
  if (NeedsEvidence(options)) {
    const std::optional<uint64_t> planes =
        ReadScenePlanesFingerprint(GetSceneModelPath(workspace.Root()));
    record.planes = planes ? std::to_string(*planes) : "";
  }
  return record;
}

ImageSelection::ImageSelection(const Workspace& workspace,
                               const InputFingerprints& inputs,
                               std::vector<bool> has_maps,
                               std::vector<bool> is_listed,
                               const ImageRecord& expected)
    : workspace_(workspace),
      inputs_(inputs),
      has_maps_(std::move(has_maps)),
      is_listed_(std::move(is_listed)),
      options_hash_(expected.options_hash),
      is_needed_(workspace.Model().images.size()) {
  for (size_t index = 0; index < NumImages(); ++index) {
    const int image = Reference(index);
    is_done_.push_back(IsDone(workspace, image, expected));
    records_.push_back(
        ReadRecord(workspace.Paths(image, workspace.Type()).record));
    if (records_.back() && records_.back()->status != ImageStatus::kDone) {
      records_.back() = std::nullopt;
    }
    if (IsToBeRefined(index)) {
      is_any_needed_ = true;
      for (const int view : SourcesAndReference(index)) {
        is_needed_[view] = true;
      }
    }
  }
}

std::vector<int> ImageSelection::Sources(size_t index) const {
  std::vector<int> sources;
  std::ranges::copy_if(Problem(index).sources,
                       std::back_inserter(sources),
                       [&](int source) { return HasMaps(source); });
  return sources;
}

std::vector<int> ImageSelection::SourcesAndReference(size_t index) const {
  std::vector<int> views = Sources(index);
  views.push_back(Reference(index));
  return views;
}

bool ImageSelection::CanRefine(size_t index) const {
  return HasMaps(Reference(index)) && !Sources(index).empty();
}

size_t ImageSelection::NumListed() const {
  return static_cast<size_t>(std::ranges::count(is_listed_, true));
}

bool ImageSelection::IsToBeRefined(size_t index) const {
  return IsListed(index) && CanRefine(index) && !HasBeenRefined(index);
}

void ImageSelection::RequireOthersFit(const std::filesystem::path& list) const {
  for (size_t index = 0; index < NumImages(); ++index) {
    if (!IsListed(index) && IsAnyNeeded() && records_[index] &&
        !is_done_[index]) {
      throw Error::File(
          ErrorCode::kUnsupported,
          list.string(),
          "leaves out " + Name(index) +
              ", which was refined with other options, or from what has "
              "changed since, and would no longer fit the others",
          "leave " + OptionName("image_list_path") + " out, or give another " +
              OptionName("output_path"));
    }
  }
}

void ImageSelection::WarnOfChanges() const {
  std::string first;
  int num_again = 0;
  for (size_t index = 0; index < NumImages(); ++index) {
    if (IsToBeRefined(index) && records_[index] &&
        records_[index]->options_hash == options_hash_) {
      first = num_again == 0 ? Name(index) : first;
      ++num_again;
    }
  }
  if (num_again == 0) {
    return;
  }
  const Manifest manifest = ReadManifestInputs(workspace_);
  std::string reason = inputs_.ChangesSince(manifest.inputs);
  if (manifest.version != TSAR_VERSION) {
    reason = "another version refined them";
  } else if (reason.empty()) {
    reason = "some of what was written for them is missing or has changed";
  }
  Warn(AndMore(first, static_cast<size_t>(num_again)) +
       ": refined again, since " + reason);
}

ImageReport ImageSelection::Begin(size_t index) const {
  const int image = Reference(index);
  const std::string type = ToString(workspace_.Type());
  ImageReport report;
  if (!IsListed(index)) {
    report.outcome = ImageReport::Outcome::kNotListed;
    return report;
  }
  if (!HasMaps(image)) {
    report.reason =
        "it has no " + type + " maps; " +
        AdviceForMissing(workspace_.Paths(image, workspace_.Type()).depth,
                         "run patch_match_stereo for this image");
  } else if (Problem(index).sources.empty()) {
    report.reason = Problem(index).without_sources;
  } else if (Sources(index).empty()) {
    report.reason = "none of its source images has " + type + " maps";
  } else if (HasBeenRefined(index)) {
    report.outcome = ImageReport::Outcome::kSkipped;
    // The counts of the run that refined it.
    report.counts = records_[index]->counts;
  }
  if (!CanRefine(index)) {
    report.outcome = ImageReport::Outcome::kKept;
  }
  return report;
}

}  // namespace tsar
