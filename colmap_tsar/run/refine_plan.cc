// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/refine_plan.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/image_lists.h"
#include "colmap_tsar/run/store/manifest.h"
#include "colmap_tsar/run/store/write_back.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <unordered_map>
#include <utility>

namespace tsar {
namespace {

// The record of the image's last refinement; nothing where it was kept or not
// begun.
std::optional<ImageRecord> ReadRecordOfDone(const Workspace& workspace,
                                            int image) {
  std::optional<ImageRecord> record =
      ReadRecord(workspace.Paths(image, workspace.Type()).record);
  return record && record->status == ImageStatus::kDone ? record : std::nullopt;
}

}  // namespace

std::vector<bool> FindListedImages(const Workspace& workspace,
                                   const std::filesystem::path& list) {
  const std::vector<StereoProblem>& problems = workspace.Problems();
  if (list.empty()) {
    return std::vector<bool>(problems.size(), true);
  }
  std::unordered_map<int, size_t> places;
  for (size_t i = 0; i < problems.size(); ++i) {
    places.emplace(problems[i].reference, i);
  }
  std::vector<bool> is_listed(problems.size());
  for (const ListedImage& listed :
       ReadImageList(list, workspace.Model(), OptionName("image_list_path"))) {
    const auto place = places.find(listed.image);
    if (place == places.end()) {
      throw Error::File(ErrorCode::kMismatch,
                        list.string(),
                        "line " + std::to_string(listed.line) + " names " +
                            workspace.Name(listed.image) +
                            ", which stereo/patch-match.cfg gives no sources",
                        "correct the line");
    }
    is_listed[place->second] = true;
  }
  return is_listed;
}

RefinePlan::RefinePlan(const Workspace& workspace,
                       const InputFingerprints& inputs,
                       std::vector<bool> has_maps,
                       std::vector<bool> is_listed,
                       std::string options_hash,
                       std::string planes)
    : workspace_(workspace),
      inputs_(inputs),
      has_maps_(std::move(has_maps)),
      is_listed_(std::move(is_listed)),
      options_hash_(std::move(options_hash)),
      planes_(std::move(planes)),
      is_done_(workspace.Problems().size()),
      users_(workspace.Model().images.size()) {
  for (size_t index = 0; index < NumImages(); ++index) {
    if (CanRefine(index)) {
      for (const int view : SourcesAndReference(index)) {
        users_[view].push_back(index);
      }
    }
    is_done_[index] = IsCurrent(Reference(index));
    is_any_needed_ = is_any_needed_ || IsToBeRefined(index);
  }
}

std::vector<int> RefinePlan::Sources(size_t index) const {
  std::vector<int> sources;
  std::ranges::copy_if(Problem(index).sources,
                       std::back_inserter(sources),
                       [&](int source) { return HasMaps(source); });
  return sources;
}

std::vector<int> RefinePlan::SourcesAndReference(size_t index) const {
  std::vector<int> views = Sources(index);
  views.push_back(Reference(index));
  return views;
}

bool RefinePlan::CanRefine(size_t index) const {
  return HasMaps(Reference(index)) && !Sources(index).empty();
}

size_t RefinePlan::NumListed() const {
  return static_cast<size_t>(std::ranges::count(is_listed_, true));
}

bool RefinePlan::IsCurrent(int image) const {
  ImageRecord expected;
  expected.options_hash = options_hash_;
  expected.inputs = inputs_.OfRun();
  expected.planes = planes_;
  return IsDone(workspace_, image, expected);
}

bool RefinePlan::IsToBeRefined(size_t index) const {
  return IsListed(index) && CanRefine(index) && !HasBeenRefined(index);
}

bool RefinePlan::IsNeeded(size_t index) const {
  return std::ranges::any_of(users_[Reference(index)], [&](size_t other) {
    return IsToBeRefined(other);
  });
}

void RefinePlan::RequireOthersFit(const std::filesystem::path& list) const {
  for (size_t index = 0; index < NumImages(); ++index) {
    if (!IsListed(index) && IsAnyNeeded() &&
        ReadRecordOfDone(workspace_, Reference(index)) &&
        !IsCurrent(Reference(index))) {
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

void RefinePlan::WarnOfChanges() const {
  std::string first;
  int num_again = 0;
  for (size_t index = 0; index < NumImages(); ++index) {
    if (!IsToBeRefined(index)) {
      continue;
    }
    const std::optional<ImageRecord> record =
        ReadRecordOfDone(workspace_, Reference(index));
    if (record && record->options_hash == options_hash_) {
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
  Warn(first +
       (num_again > 1 ? " and " + std::to_string(num_again - 1) + " more"
                      : std::string()) +
       ": refined again, since " + reason);
}

ImageReport RefinePlan::Begin(size_t index) const {
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
        AdviceForMissing(workspace_.DepthPath(image, workspace_.Type()),
                         "run patch_match_stereo for this image");
  } else if (Problem(index).sources.empty()) {
    report.reason = Problem(index).without_sources;
  } else if (Sources(index).empty()) {
    report.reason = "none of its source images has " + type + " maps";
  } else if (HasBeenRefined(index)) {
    report.outcome = ImageReport::Outcome::kSkipped;
    // The counts of the run that refined it.
    report.counts = ReadRecordOfDone(workspace_, image)->counts;
  }
  if (!CanRefine(index)) {
    report.outcome = ImageReport::Outcome::kKept;
  }
  return report;
}

}  // namespace tsar
