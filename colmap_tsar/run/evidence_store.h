// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/shared_cache.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace tsar {

// Whether images are refined together with their neighbors, which needs the
// evidence of all views.
bool NeedsEvidence(const RefineOptions& options);

// The evidence of a workspace's views, kept in files of stereo/tsar/evidence
// from their observation to the end of the run, so that a killed run resumes
// from there. The most recently read evidence is kept in memory. Can be used
// from several threads.
class EvidenceStore {
 public:
  using Evidence = std::shared_ptr<const ViewEvidence>;

  // workspace must outlive this object. key: a fingerprint of the options and
  // inputs; evidence of others does not count. max_num_views: how many are kept
  // in memory.
  EvidenceStore(const Workspace& workspace,
                std::string key,
                size_t max_num_views);

  const std::string& Key() const { return key_; }

  // Whether the image was observed with these options, from these inputs.
  // Always false for an image that is no reference, since its evidence would
  // never be updated.
  bool IsObserved(int image);
  // Throws kNotFound, naming the file, for a reference that was not.
  void RequireObserved(int image);
  // Whether the image was observed, and there was something to observe.
  bool IsCurrent(int image);

  // image must be a reference.
  void Write(int image, const ViewEvidence& evidence);
  // Notes that there is nothing to observe in the image.
  void WriteNothing(int image);

  // Removes the priors from all evidence if more of them were dropped for
  // explaining too little than are in use: then they belong to another scene,
  // and those in use fit by chance. To be called when all views were observed,
  // before evidence is read.
  void RemoveUnlikePriors();

  // The complete evidence, for the view itself.
  ViewEvidence ReadAll(int image) const;
  // The part of the evidence that neighbors need; null where there is nothing
  // to observe, and for an image that is no reference. Throws what
  // RequireObserved() throws.
  Evidence Get(int image);

  // Removes the evidence of all images, whatever its options and inputs.
  static void Clear(const Workspace& workspace);

 private:
  ContainedPath Path(int image) const;

  const Workspace& workspace_;
  const std::string key_;
  std::vector<bool> is_reference_;  // By image.
  SharedCache<ViewEvidence> views_;
};

}  // namespace tsar
