// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/evidence_store.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/evidence_file.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <algorithm>
#include <sstream>
#include <system_error>
#include <utility>

namespace tsar {
namespace {

// Adds size and time of a file, or "-" where there is none.
void AddFileState(const std::filesystem::path& path, std::ostream& text) {
  std::error_code error;
  const uintmax_t size = std::filesystem::file_size(path, error);
  if (error) {
    text << " -";
    return;
  }
  const auto time = std::filesystem::last_write_time(path, error);
  text << " " << size << "@" << time.time_since_epoch().count();
}

}  // namespace

EvidenceStore::EvidenceStore(const Workspace& workspace,
                             std::string options_hash,
                             size_t max_num_views)
    : workspace_(workspace),
      options_hash_(std::move(options_hash)),
      max_num_views_(max_num_views) {}

bool EvidenceStore::IsCurrent(int image) const {
  return ReadEvidenceHash(Path(image)) == Fingerprint(image);
}

bool EvidenceStore::Has(int image) const {
  std::error_code error;
  return std::filesystem::exists(Path(image), error);
}

void EvidenceStore::Write(int image, const ViewEvidence& evidence) const {
  WriteEvidence(Path(image), Fingerprint(image), evidence);
}

ViewEvidence EvidenceStore::ReadAll(int image) const {
  return ReadEvidence(Path(image));
}

EvidenceStore::Evidence EvidenceStore::Get(int image) {
  const auto find = [&] {
    return std::find_if(views_.begin(), views_.end(), [&](const auto& entry) {
      return entry.first == image;
    });
  };
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto entry = find();
    if (entry != views_.end()) {
      views_.splice(views_.begin(), views_, entry);
      return entry->second;
    }
  }
  // Two threads may read the same one: better than that all wait for one file.
  auto evidence = std::make_shared<const ViewEvidence>(
      ReadEvidence(Path(image), EvidenceParts::kForNeighbours));
  const std::lock_guard<std::mutex> lock(mutex_);
  if (find() == views_.end()) {
    views_.emplace_front(image, evidence);
    if (views_.size() > max_num_views_) {
      views_.pop_back();
    }
  }
  return evidence;
}

void EvidenceStore::Clear() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    views_.clear();
  }
  std::error_code error;
  std::filesystem::remove_all(Folder(), error);
  if (error) {
    throw Error::File(ErrorCode::kIo,
                      Folder().string(),
                      "cannot be removed: " + error.message(),
                      "remove the folder by hand");
  }
}

std::filesystem::path EvidenceStore::Folder() const {
  return GetTsarFolder(workspace_.Root()) / "evidence";
}

std::filesystem::path EvidenceStore::Path(int image) const {
  const std::string& name =
      workspace_.Model().images[static_cast<size_t>(image)].name;
  return Folder() / (name + "." + ToString(workspace_.Type()) + ".bin");
}

std::string EvidenceStore::Fingerprint(int image) const {
  std::ostringstream text;
  text << options_hash_;
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    const MapPaths paths = workspace_.SourcePaths(image, type);
    for (const std::filesystem::path& path : {paths.depth,
                                              paths.normal,
                                              paths.original_depth,
                                              paths.original_normal}) {
      AddFileState(path, text);
    }
  }
  return text.str();
}

}  // namespace tsar
