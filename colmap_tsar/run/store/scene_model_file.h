// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/run/store/state_file.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace tsar {

// The file that keeps the planes of the whole scene, stereo/tsar/planes.bin: a
// state file (state_file.h) of two parts, the planes, frames and cylinders, and
// the labels of all views.

// The key of such a file tells whether the model may be used.
inline constexpr StateFileKind kSceneModelFile = {
    {'T', 'S', 'A', 'R', 'P', 'L', 'A', 'N'},
    /*version=*/6,
    "file of planes",
    "there are no planes of the scene",
    "run tsar_refine on this workspace first"};

enum class SceneModelParts {
  kAll,
  // Everything but the views, which stay empty and are not read.
  kWithoutLabels,
};

ContainedPath GetSceneModelPath(const std::filesystem::path& root);

// Writes the file atomically; creates the folder. The same model gives the same
// bytes. key: a fingerprint of all inputs of the model. Warns where there are
// more planes than plane maps can represent. Throws kIo.
void WriteSceneModel(const ContainedPath& path,
                     const std::string& key,
                     const SceneModel& model);

// Throws kNotFound, kIo, or kCorrupt where the file is damaged in the requested
// parts or not of this format's version. A file whose labels were dropped has
// no views.
SceneModel ReadSceneModel(const std::filesystem::path& path,
                          SceneModelParts parts = SceneModelParts::kAll);

// The checksum of a file's planes, with or without labels; nothing where there
// is no file or its planes are damaged.
std::optional<uint64_t> ReadScenePlanesFingerprint(
    const std::filesystem::path& path);

// At the end of a complete run, removes the labels and, of the key, what comes
// after its first word: the fingerprint of the inputs. So the same maps give
// the same bytes.
void DropSceneLabels(const ContainedPath& path);

}  // namespace tsar
