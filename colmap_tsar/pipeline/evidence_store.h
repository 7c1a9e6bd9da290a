// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/planes/view_evidence.h"
#include "colmap_tsar/workspace/workspace.h"

#include <cstddef>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tsar {

// The evidence of a workspace's views, in files of stereo/tsar/evidence from
// the time a view was observed until the run ends, so that a killed run goes on
// from there. What was read last is kept in memory. Can be used from several
// threads.
class EvidenceStore {
 public:
  using Evidence = std::shared_ptr<const ViewEvidence>;

  // workspace must outlive this object. options_hash: evidence of other options
  // does not count. max_num_views: how many are kept in memory.
  EvidenceStore(const Workspace& workspace,
                std::string options_hash,
                size_t max_num_views);

  // Whether there is evidence of the image that was made with these options
  // from these sources, cameras, pictures and original maps. Never of an image
  // that is no reference: nobody would renew it. The state of the files is that
  // of the first call that needs it, which must come before they are read;
  // throws what FindOriginals throws.
  bool IsCurrent(int image);

  // From now on, evidence counts that has the fingerprint given for its image,
  // or for an image without one none, whatever the files are now: other
  // programs may be at work on those. IsCurrent() and Get() then throw
  // kMismatch where a file has another one or is gone.
  void Expect(std::map<int, std::string> fingerprints);

  // What the evidence of a reference is made of, and with which options.
  std::string Fingerprint(int image);
  // Of the reference's own files and those of its sources that are no
  // references: all that no other image's tells.
  std::string FingerprintOfFiles(int image);

  // image must be a reference.
  void Write(int image, const ViewEvidence& evidence);

  // All of it, for the view itself.
  ViewEvidence ReadAll(int image) const;
  // What its neighbours need; null where none is current.
  Evidence Get(int image);

  // Removes the evidence of all images, whatever it was made with.
  static void Clear(const Workspace& workspace);

 private:
  ContainedPath Path(int image) const;

  // What the view is loaded from.
  const std::string& State(int image);
  const Workspace& workspace_;
  const std::string options_hash_;
  const size_t max_num_views_;
  // By image; null where it is no reference.
  std::vector<const StereoProblem*> problems_;
  std::optional<std::map<int, std::string>> expected_;
  // By image, once the flag is set.
  std::vector<std::string> states_;
  std::vector<std::once_flag> state_flags_;
  std::mutex mutex_;
  std::list<std::pair<int, Evidence>> views_;  // The latest used first.
};

}  // namespace tsar
