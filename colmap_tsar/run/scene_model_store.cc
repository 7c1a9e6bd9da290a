// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/scene_model_store.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/store/scene_model_file.h"
#include "colmap_tsar/scene/find_scene.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

namespace tsar {
namespace {

void WarnOfPlanesWithoutName(size_t num_planes) {
  if (num_planes > size_t{kMaxPlanesOfMap}) {
    Warn("the scene has " + std::to_string(num_planes) +
         " planes, of which plane maps can name " +
         std::to_string(kMaxPlanesOfMap) + ": the " +
         std::to_string(num_planes - size_t{kMaxPlanesOfMap}) +
         " that least was measured of are missing in stereo/plane_maps, and "
         "tsar_planes gives them no outlines; depths and normals, and the "
         "list of planes in stereo/tsar/planes.bin, are complete");
  }
}

}  // namespace

SceneModelStore::SceneModelStore(const Workspace& workspace,
                                 const InputFingerprints& inputs,
                                 std::string options_hash)
    : workspace_(workspace),
      inputs_(inputs),
      options_hash_(std::move(options_hash)) {}

bool SceneModelStore::IsCurrent() const {
  return ReadSceneModelKey(GetSceneModelPath(workspace_.Root())) ==
         Fingerprint();
}

void SceneModelStore::Write(const SceneModel& model) const {
  WarnOfPlanesWithoutName(model.planes.size());
  WriteSceneModel(GetSceneModelPath(workspace_.Root()), Fingerprint(), model);
}

SceneModel SceneModelStore::Read() const {
  const ContainedPath path = GetSceneModelPath(workspace_.Root());
  if (!IsCurrent()) {
    throw Error::File(
        ErrorCode::kNotFound,
        path.string(),
        "holds no planes that were found in these views with these options",
        "run " + OptionName("pass") + " model first");
  }
  return ReadSceneModel(path);
}

std::string SceneModelStore::PlanesFingerprint() const {
  const std::optional<uint64_t> planes =
      ReadScenePlanesFingerprint(GetSceneModelPath(workspace_.Root()));
  return planes ? std::to_string(*planes) : "";
}

void SceneModelStore::DropLabels(const Workspace& workspace) {
  const ContainedPath path = GetSceneModelPath(workspace.Root());
  const std::string hash = ReadSceneModelKey(path).value_or("");
  const size_t end = hash.find(' ');
  if (end != std::string::npos) {
    WriteSceneModel(path,
                    hash.substr(0, end),
                    ReadSceneModel(path, SceneModelParts::kWithoutLabels),
                    SceneModelParts::kWithoutLabels);
  }
}

void SceneModelStore::Remove(const Workspace& workspace) {
  RemoveFile(GetSceneModelPath(workspace.Root()));
}

std::string SceneModelStore::Fingerprint() const {
  return options_hash_ + " " + inputs_.OfRun();
}

}  // namespace tsar
