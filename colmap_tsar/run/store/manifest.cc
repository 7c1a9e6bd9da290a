// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/manifest.h"

#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/json_file.h"
#include "colmap_tsar/view/refine_option_list.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

ContainedPath PathOf(const Workspace& workspace) {
  return GetTsarFolder(workspace.Root()) / "manifest.json";
}

}  // namespace

int Manifest::NumImages(ImageStatus status) const {
  return static_cast<int>(
      std::ranges::count(images, status, &ImageRecord::status));
}

Manifest BuildManifest(const Workspace& workspace,
                       const RefineOptions& options,
                       std::map<std::string, std::string> inputs) {
  Manifest manifest;
  manifest.version = TSAR_VERSION;
  manifest.type = ToString(workspace.Type());
  manifest.options = RefineOptionsText(options);
  manifest.inputs = std::move(inputs);
  const std::vector<int> references = workspace.References();
  if (const auto num_masks = workspace.CountMasks(references)) {
    manifest.runtime["masks"] = std::to_string(*num_masks);
  }
  if (const auto num_priors = workspace.Priors().Count(references)) {
    manifest.runtime["depth_priors"] = std::to_string(*num_priors);
  }
  const std::string options_hash = HashRefineOptions(options);
  for (const int image : references) {
    std::optional<ImageRecord> record =
        ReadRecord(workspace.Paths(image, workspace.Type()).record);
    if (!record || record->options_hash != options_hash) {
      record.emplace();
    }
    record->image = workspace.Name(image);
    for (const auto& [name, count] : record->counts) {
      manifest.counts[name] += count;
    }
    for (const auto& [name, seconds] : record->seconds) {
      manifest.seconds[name] += seconds;
    }
    manifest.images.push_back(*std::move(record));
  }
  return manifest;
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
  for (const ImageRecord& entry : manifest.images) {
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
