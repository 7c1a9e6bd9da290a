// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/lru_map.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"
#include "colmap_tsar/view/refine_options.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

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

  // workspace and inputs must outlive this object. options_hash: evidence of
  // other options does not count. max_num_views: how many are kept in memory.
  EvidenceStore(const Workspace& workspace,
                const InputFingerprints& inputs,
                std::string options_hash,
                size_t max_num_views);

  // Whether there is evidence of the image that was made with these options
  // from the inputs of this run. Always false for an image that is no
  // reference: nobody would renew its evidence.
  bool IsCurrent(int image);

  // Declares that there is evidence of exactly these images. From then on
  // IsCurrent() and Get() throw kMismatch where it was made of something else
  // or is gone.
  void Expect(std::set<int> images);

  // image must be a reference.
  void Write(int image, const ViewEvidence& evidence);

  // Removes the priors from all evidence if more of them were dropped for
  // explaining too little than are in use: then they are those of another
  // scene, of which a few fit by chance. To be called when all views were
  // observed, before evidence is read.
  void RemoveUnlikePriors();

  // The complete evidence, for the view itself.
  ViewEvidence ReadAll(int image) const;
  // The part of the evidence that neighbors need; null where none is current.
  Evidence Get(int image);

  // Removes the evidence of all images, whatever its options and inputs.
  static void Clear(const Workspace& workspace);

 private:
  ContainedPath Path(int image) const;

  // A fingerprint of the inputs and options of the evidence.
  std::string Fingerprint() const;

  const Workspace& workspace_;
  const InputFingerprints& inputs_;
  const std::string options_hash_;
  const size_t max_num_views_;
  std::optional<std::set<int>> expected_;
  std::mutex mutex_;
  LruMap<int, Evidence> views_;  // By image.
};

}  // namespace tsar
