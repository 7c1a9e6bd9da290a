// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/manifest.h"

#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/json_file.h"

#include <algorithm>
#include <optional>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

ContainedPath PathOf(const Workspace& workspace) {
  return GetTsarFolder(workspace.Root()) / "manifest.json";
}

}  // namespace

int Manifest::NumImages(ImageStatus status) const {
  return static_cast<int>(std::ranges::count(images, status, &Entry::status));
}

Manifest BuildManifest(const Workspace& workspace,
                       const std::map<std::string, std::string>& options,
                       const std::string& options_hash) {
  Manifest manifest;
  manifest.version = TSAR_VERSION;
  manifest.type = ToString(workspace.Type());
  manifest.options = options;
  for (const StereoProblem& problem : workspace.Problems()) {
    Manifest::Entry entry;
    entry.image = workspace.Name(problem.reference);
    const std::optional<ImageRecord> record =
        ReadRecord(workspace.Paths(problem.reference, workspace.Type()).record);
    if (record && record->options_hash == options_hash) {
      entry.status = record->status;
      entry.note = record->note;
      entry.counts = record->counts;
      entry.seconds = record->seconds;
    }
    for (const auto& [name, count] : entry.counts) {
      manifest.counts[name] += count;
    }
    for (const auto& [name, seconds] : entry.seconds) {
      manifest.seconds[name] += seconds;
    }
    manifest.images.push_back(std::move(entry));
  }
  return manifest;
}

void NoteMasksAndPriors(const std::optional<int64_t>& num_masks,
                        const std::optional<int64_t>& num_priors,
                        Manifest* manifest) {
  if (num_masks) {
    manifest->runtime["masks"] = std::to_string(*num_masks);
  }
  if (num_priors) {
    manifest->runtime["depth_priors"] = std::to_string(*num_priors);
  }
}

Manifest ReadManifestInputs(const Workspace& workspace) {
  Manifest manifest;
  InputFile file(PathOf(workspace).Path());
  try {
    const nlohmann::json json = nlohmann::json::parse(file);
    json.at("version").get_to(manifest.version);
    json.at("inputs").get_to(manifest.inputs);
  } catch (const nlohmann::json::exception&) {
    return Manifest();
  }
  return manifest;
}

void WriteManifest(const Workspace& workspace, const Manifest& manifest) {
  nlohmann::json images = nlohmann::json::array();
  for (const Manifest::Entry& entry : manifest.images) {
    images.push_back({{"image", entry.image},
                      {"status", ToString(entry.status)},
                      {"note", entry.note},
                      {"counts", entry.counts},
                      {"seconds", entry.seconds}});
  }
  nlohmann::json totals;
  for (const ImageStatus status : {ImageStatus::kPending,
                                   ImageStatus::kDone,
                                   ImageStatus::kKept,
                                   ImageStatus::kFailed}) {
    totals[ToString(status)] = manifest.NumImages(status);
  }
  const nlohmann::json json = {{"version", manifest.version},
                               {"type", manifest.type},
                               {"options", manifest.options},
                               {"runtime", manifest.runtime},
                               {"inputs", manifest.inputs},
                               {"num_images", totals},
                               {"counts", manifest.counts},
                               {"seconds", manifest.seconds},
                               {"images", images}};
  WriteJson(PathOf(workspace), json);
}

}  // namespace tsar
