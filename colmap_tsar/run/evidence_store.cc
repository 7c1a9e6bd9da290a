// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/evidence_store.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/run/store/evidence_file.h"

#include <optional>
#include <utility>

namespace tsar {
namespace {

// What the key of a file without evidence has in addition.
constexpr const char* kNothing = " nothing";

}  // namespace

bool NeedsEvidence(const RefineOptions& options) {
  return options.scene_planes && options.refine;
}

EvidenceStore::EvidenceStore(const Workspace& workspace,
                             std::string key,
                             size_t max_num_views)
    : workspace_(workspace),
      key_(std::move(key)),
      is_reference_(workspace.Model().images.size()),
      views_(max_num_views) {
  for (const StereoProblem& problem : workspace.Problems()) {
    is_reference_[problem.reference] = true;
  }
}

bool EvidenceStore::IsObserved(int image) {
  const std::optional<std::string> key =
      ReadStateFileKey(Path(image), kEvidenceFile);
  return is_reference_[image] && (key == key_ || key == key_ + kNothing);
}

void EvidenceStore::RequireObserved(int image) {
  if (is_reference_[image] && !IsObserved(image)) {
    throw Error::File(
        ErrorCode::kNotFound,
        Path(image).string(),
        workspace_.Name(image) +
            " was not observed with these options, or an input "
            "of the run has changed since",
        "run " + OptionName("pass") + " observe of all shards again");
  }
}

bool EvidenceStore::IsCurrent(int image) {
  return is_reference_[image] &&
         ReadStateFileKey(Path(image), kEvidenceFile) == key_;
}

void EvidenceStore::Write(int image, const ViewEvidence& evidence) {
  WriteEvidence(Path(image), key_, evidence);
}

void EvidenceStore::WriteNothing(int image) {
  WriteEvidence(Path(image), key_ + kNothing, {});
}

void EvidenceStore::RemoveUnlikePriors() {
  std::vector<int> in_use;  // Images with a prior in use, if only of normals.
  int num_used = 0;
  int num_unlike = 0;
  for (const StereoProblem& problem : workspace_.Problems()) {
    const int image = problem.reference;
    if (workspace_.Priors().HasPrior(image) && IsCurrent(image)) {
      const PriorAssessment prior =
          ReadEvidence(Path(image), EvidenceParts::kForNeighbors)
              .prior.assessment;
      num_used += prior.verdict == PriorVerdict::kUsed ? 1 : 0;
      num_unlike += prior.verdict == PriorVerdict::kUnlike ? 1 : 0;
      if (prior.IsUsed()) {
        in_use.push_back(image);
      }
    }
  }
  if (num_unlike <= num_used) {
    return;
  }
  for (const int image : in_use) {
    ViewEvidence evidence = ReadAll(image);
    RemovePrior(&evidence);
    Write(image, evidence);
  }
}

ViewEvidence EvidenceStore::ReadAll(int image) const {
  return ReadEvidence(Path(image));
}

EvidenceStore::Evidence EvidenceStore::Get(int image) {
  if (Evidence evidence = views_.Find(image)) {
    return evidence;
  }
  RequireObserved(image);
  if (!IsCurrent(image)) {
    return nullptr;
  }
  return views_.Get(image, [&](Evidence) {
    return std::make_shared<const ViewEvidence>(
        ReadEvidence(Path(image), EvidenceParts::kForNeighbors));
  });
}

void EvidenceStore::Clear(const Workspace& workspace) {
  RemoveTree(GetEvidenceFolder(workspace.Root()));
}

ContainedPath EvidenceStore::Path(int image) const {
  return GetEvidencePath(
      workspace_.Root(), workspace_.Name(image), workspace_.Type());
}

}  // namespace tsar
