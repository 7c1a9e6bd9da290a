// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/scene/evidence/scene_model.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace tsar {

// The file that keeps the planes of the whole scene, stereo/tsar/planes.bin.
// Little-endian, without padding: a header of fixed size (magic, format
// version, all counts, fingerprints), the options hash, the planes, the frames,
// the cylinders, then the labels: for each view its image and number of
// superpixels, the planes of all superpixels, their evidence, their qualities.
// Planes with frames and cylinders, and labels, have a fingerprint each.

enum class SceneModelParts {
  kAll,
  // Everything but the views, which stay empty and are not read or written.
  kWithoutLabels,
};

ContainedPath GetSceneModelPath(const std::filesystem::path& root);

// Writes the file atomically; creates the folder. The same model gives the same
// bytes. options_hash: a hash of all inputs of the model. Error kMismatch for a
// model that ReadSceneModel() would not accept, kIo.
void WriteSceneModel(const ContainedPath& path,
                     const std::string& options_hash,
                     const SceneModel& model,
                     SceneModelParts parts = SceneModelParts::kAll);

// The result satisfies the invariants of SceneModel. Error kNotFound, kIo, or
// kCorrupt where the file is damaged, not of this format's version, or violates
// an invariant. The file's length is checked before memory is allocated. A file
// that was written without labels has no views.
SceneModel ReadSceneModel(const std::filesystem::path& path,
                          SceneModelParts parts = SceneModelParts::kAll);

// The fingerprint of a file's planes, with or without labels; nothing where
// there is no file or its planes are damaged.
std::optional<uint64_t> ReadScenePlanesFingerprint(
    const std::filesystem::path& path);

// The options hash in a file's header, which tells whether the model may be
// used. Nothing where there is no file, or none with an intact header, of this
// format's version and of the length that the header gives.
std::optional<std::string> ReadSceneModelHash(
    const std::filesystem::path& path);

}  // namespace tsar
