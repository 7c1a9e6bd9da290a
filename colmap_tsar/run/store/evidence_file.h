// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/state_file.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <filesystem>
#include <string>

namespace tsar {

// The file that keeps a view's evidence for its neighbors: a state file
// (state_file.h) of two parts, what neighbors need and what only the view
// itself needs.

// The key of such a file tells whether the evidence may be used.
inline constexpr StateFileKind kEvidenceFile = {
    {'T', 'S', 'A', 'R', 'V', 'I', 'E', 'W'},
    /*version=*/15,
    "evidence file",
    "no such file",
    "run again without removing files meanwhile"};

enum class EvidenceParts {
  kAll,
  // Everything but the values of the prior, the confirmed depths, borders, gray
  // levels and flags, which stay empty and are not even read from the disk.
  kForNeighbors,
};

// stereo/tsar/evidence: the evidence of all views of the workspace at root.
ContainedPath GetEvidenceFolder(const std::filesystem::path& root);
// The file of one view. type: the type of the maps that were observed.
ContainedPath GetEvidencePath(const std::filesystem::path& root,
                              const std::string& image_name,
                              MapType type);

// Writes the file atomically; creates the folder. The same evidence gives the
// same bytes. key: a fingerprint of all inputs of the evidence. Throws kIo.
void WriteEvidence(const ContainedPath& path,
                   const std::string& key,
                   const ViewEvidence& evidence);

// Throws kNotFound, kIo, or kCorrupt where the file is damaged in the requested
// parts or not of this format's version.
ViewEvidence ReadEvidence(const std::filesystem::path& path,
                          EvidenceParts parts = EvidenceParts::kAll);

}  // namespace tsar
