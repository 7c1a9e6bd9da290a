// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/planes/view_evidence.h"
#include "colmap_tsar/workspace/workspace.h"

#include <cstddef>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <string>

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
  // from the maps as they are now.
  bool IsCurrent(int image) const;
  // Whether there is any, for those who know that it is current.
  bool Has(int image) const;

  void Write(int image, const ViewEvidence& evidence) const;

  // All of it, for the view itself.
  ViewEvidence ReadAll(int image) const;
  // What its neighbours need.
  Evidence Get(int image);

  // Removes all files, once nobody needs them any more.
  void Clear();

 private:
  std::filesystem::path Folder() const;
  std::filesystem::path Path(int image) const;
  // Changes with the options and whenever a map of the image does.
  std::string Fingerprint(int image) const;

  const Workspace& workspace_;
  const std::string options_hash_;
  const size_t max_num_views_;
  std::mutex mutex_;
  std::list<std::pair<int, Evidence>> views_;  // The latest used first.
};

}  // namespace tsar
