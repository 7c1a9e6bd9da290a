// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/evidence_store.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/workspace/atomic_file.h"
#include "colmap_tsar/workspace/content_hash.h"
#include "colmap_tsar/workspace/evidence_file.h"
#include "colmap_tsar/workspace/map_paths.h"
#include "colmap_tsar/workspace/originals.h"

#include <algorithm>
#include <sstream>
#include <system_error>
#include <utility>

namespace tsar {
namespace {

ContainedPath EvidenceFolder(const Workspace& workspace) {
  return GetTsarFolder(workspace.Root()) / "evidence";
}

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

// Changes whenever what a view is loaded from does, but not when its maps are
// refined.
std::string ViewState(const Workspace& workspace, int image) {
  std::ostringstream text;
  const SparseModel::ModelImage& entry =
      workspace.Model().images[static_cast<size_t>(image)];
  const Camera& camera = entry.camera;
  text << entry.name << std::hexfloat;
  for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) {
    text << " " << value;
  }
  for (const double value : camera.rotation.reshaped()) {
    text << " " << value;
  }
  for (const double value : camera.translation) {
    text << " " << value;
  }
  AddFileState(workspace.ImagePath(image), text);
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    const MapPaths paths = workspace.SourcePaths(image, type);
    const OriginalMaps originals = FindOriginals(paths);
    AddFileState(originals.depth, text);
    AddFileState(originals.normal, text);
    AddFileState(paths.cost, text);
  }
  return text.str();
}

}  // namespace

EvidenceStore::EvidenceStore(const Workspace& workspace,
                             std::string options_hash,
                             size_t max_num_views)
    : workspace_(workspace),
      options_hash_(std::move(options_hash)),
      max_num_views_(max_num_views),
      problems_(workspace.Model().images.size()),
      states_(workspace.Model().images.size()),
      state_flags_(workspace.Model().images.size()) {
  for (const StereoProblem& problem : workspace.Problems()) {
    problems_[static_cast<size_t>(problem.reference)] = &problem;
  }
}

bool EvidenceStore::IsCurrent(int image) {
  if (expected_) {
    const auto found = expected_->find(image);
    if (found == expected_->end()) {
      return false;
    }
    if (ReadEvidenceHash(Path(image)) != found->second) {
      throw Error::File(
          ErrorCode::kMismatch,
          Path(image).string(),
          "the evidence has changed or gone since it was observed",
          "run the pass observe of all shards again");
    }
    return true;
  }
  return problems_[static_cast<size_t>(image)] != nullptr &&
         ReadEvidenceHash(Path(image)) == Fingerprint(image);
}

void EvidenceStore::Expect(std::map<int, std::string> fingerprints) {
  expected_ = std::move(fingerprints);
}

void EvidenceStore::Write(int image, const ViewEvidence& evidence) {
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
  if (!IsCurrent(image)) {
    return nullptr;
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

void EvidenceStore::Clear(const Workspace& workspace) {
  RemoveTree(EvidenceFolder(workspace));
}

ContainedPath EvidenceStore::Path(int image) const {
  const std::string& name =
      workspace_.Model().images[static_cast<size_t>(image)].name;
  return EvidenceFolder(workspace_) /
         (name + "." + ToString(workspace_.Type()) + ".bin");
}

const std::string& EvidenceStore::State(int image) {
  const auto index = static_cast<size_t>(image);
  std::call_once(state_flags_[index],
                 [&] { states_[index] = ViewState(workspace_, image); });
  return states_[index];
}

std::string EvidenceStore::Fingerprint(int image) {
  ContentHash hash;
  const auto add = [&](int view) {
    const std::string& state = State(view);
    hash.Update(state.data(), state.size());
  };
  add(image);
  for (const int source : problems_[static_cast<size_t>(image)]->sources) {
    add(source);
  }
  return options_hash_ + " " + std::to_string(hash.Value());
}

std::string EvidenceStore::FingerprintOfFiles(int image) {
  std::string text = State(image);
  for (const int source : problems_[static_cast<size_t>(image)]->sources) {
    if (problems_[static_cast<size_t>(source)] == nullptr) {
      text += "\n" + State(source);
    }
  }
  ContentHash hash;
  hash.Update(text.data(), text.size());
  return std::to_string(hash.Value());
}

}  // namespace tsar
