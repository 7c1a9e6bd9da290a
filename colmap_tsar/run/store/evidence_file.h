// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/scene/evidence/view_evidence.h"

#include <filesystem>
#include <optional>
#include <string>

namespace tsar {

// The file in which a view's evidence waits for its neighbours. Little-endian,
// without padding: a header of fixed size (magic, format version, all sizes,
// the raster's intrinsics, fingerprints), the options hash, the arrays that
// neighbours need, then those that only the view itself needs. Every part has
// its own fingerprint.

enum class EvidenceParts {
  kAll,
  // All but the prior, the confirmed depths, borders and ratings, which stay
  // empty and are not even read from the disk.
  kForNeighbours,
};

// stereo/tsar/evidence: the evidence of all views of the workspace at root.
ContainedPath GetEvidenceFolder(const std::filesystem::path& root);
// The file of one view in it. type: of the maps that were observed.
ContainedPath GetEvidencePath(const std::filesystem::path& root,
                              const std::string& image_name,
                              MapType type);

// In one step; creates the folder. The same evidence gives the same bytes.
// options_hash: stands for everything that the evidence was computed from.
// Error kMismatch for evidence that ReadEvidence() would not accept, kIo.
void WriteEvidence(const ContainedPath& path,
                   const std::string& options_hash,
                   const ViewEvidence& evidence);

// What is returned keeps the promises of ViewEvidence: all sizes, labels and
// numbers of planes and pixels fit each other, all numbers are finite and in
// their ranges. Error kNotFound, kIo, or kCorrupt where the file is damaged,
// not of this format's version, or breaks such a promise in the parts asked
// for. The file's length is checked before memory is allocated.
ViewEvidence ReadEvidence(const std::filesystem::path& path,
                          EvidenceParts parts = EvidenceParts::kAll);

// The options hash of a file, from its header alone: whether the evidence may
// be used. Nothing where there is no file, or none with an intact header, of
// this format's version and of the length that the header says.
std::optional<std::string> ReadEvidenceHash(const std::filesystem::path& path);

}  // namespace tsar
