// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/evidence_store.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/run/store/evidence_file.h"

#include <utility>
#include <vector>

namespace tsar {

bool NeedsEvidence(const RefineOptions& options) {
  return options.scene_planes && options.refine;
}

EvidenceStore::EvidenceStore(const Workspace& workspace,
                             const InputFingerprints& inputs,
                             std::string options_hash,
                             size_t max_num_views)
    : workspace_(workspace),
      inputs_(inputs),
      options_hash_(std::move(options_hash)),
      max_num_views_(max_num_views) {}

bool EvidenceStore::IsCurrent(int image) {
  if (inputs_.Problem(image) == nullptr ||
      (expected_ && !expected_->contains(image))) {
    return false;
  }
  const bool is_current = ReadEvidenceHash(Path(image)) == Fingerprint();
  if (expected_ && !is_current) {
    throw Error::File(
        ErrorCode::kMismatch,
        Path(image).string(),
        "the evidence, or what it was made of, has changed or "
        "gone since it was observed",
        "run " + OptionName("pass") + " observe of all shards again");
  }
  return is_current;
}

void EvidenceStore::Expect(std::set<int> images) {
  expected_ = std::move(images);
}

void EvidenceStore::Write(int image, const ViewEvidence& evidence) {
  WriteEvidence(Path(image), Fingerprint(), evidence);
}

void EvidenceStore::RemoveUnlikePriors() {
  std::vector<int> in_use;  // Images with a prior in use, if only of normals.
  int num_used = 0;
  int num_unlike = 0;
  for (const StereoProblem& problem : workspace_.Problems()) {
    const int image = problem.reference;
    if (workspace_.Priors().HasPrior(image) && IsCurrent(image)) {
      const PriorAssessment prior = ReadPriorAssessment(Path(image));
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
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (const Evidence* evidence = views_.Use(image)) {
      return *evidence;
    }
  }
  if (!IsCurrent(image)) {
    return nullptr;
  }
  // Two threads may read the same file, rather than all wait for one file.
  auto evidence = std::make_shared<const ViewEvidence>(
      ReadEvidence(Path(image), EvidenceParts::kForNeighbors));
  const std::lock_guard<std::mutex> lock(mutex_);
  if (views_.Find(image) == nullptr) {
    views_.Add(image, evidence);
    if (views_.Size() > max_num_views_) {
      views_.TakeOldest([](const Evidence&) { return true; });
    }
  }
  return evidence;
}

void EvidenceStore::Clear(const Workspace& workspace) {
  RemoveTree(GetEvidenceFolder(workspace.Root()));
}

ContainedPath EvidenceStore::Path(int image) const {
  return GetEvidencePath(
      workspace_.Root(), workspace_.Name(image), workspace_.Type());
}

std::string EvidenceStore::Fingerprint() const {
  return options_hash_ + " " + inputs_.OfRun();
}

}  // namespace tsar
