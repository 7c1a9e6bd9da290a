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

// The file that keeps a view's evidence for its neighbors. Little-endian,
// without padding: a header of fixed size (magic, format version, all sizes,
// the raster's intrinsics, fingerprints), the options hash, the arrays that
// neighbors need, then those that only the view itself needs. Every part has
// its own fingerprint.

enum class EvidenceParts {
  kAll,
  // Everything but the prior, the confirmed depths, borders and scores, which
  // stay empty and are not even read from the disk.
  kForNeighbors,
};

// stereo/tsar/evidence: the evidence of all views of the workspace at root.
ContainedPath GetEvidenceFolder(const std::filesystem::path& root);
// The file of one view. type: the type of the maps that were observed.
ContainedPath GetEvidencePath(const std::filesystem::path& root,
                              const std::string& image_name,
                              MapType type);

// Writes the file atomically; creates the folder. The same evidence gives the
// same bytes. options_hash: a hash of all inputs of the evidence. Error
// kMismatch for evidence that ReadEvidence() would not accept, kIo.
void WriteEvidence(const ContainedPath& path,
                   const std::string& options_hash,
                   const ViewEvidence& evidence);

// The result satisfies the invariants of ViewEvidence: all sizes, labels and
// indices of planes and pixels are consistent, all numbers are finite and in
// range. Error kNotFound, kIo, or kCorrupt where the file is damaged, not of
// this format's version, or violates an invariant in the requested parts. The
// file's length is checked before memory is allocated.
ViewEvidence ReadEvidence(const std::filesystem::path& path,
                          EvidenceParts parts = EvidenceParts::kAll);

// The assessment of the view's prior, from the file's header. Throws what
// ReadEvidence() throws.
PriorAssessment ReadPriorAssessment(const std::filesystem::path& path);

// The options hash in a file's header, which tells whether the evidence may be
// used. Nothing where there is no file, or none with an intact header, of this
// format's version and of the length that the header gives.
std::optional<std::string> ReadEvidenceHash(const std::filesystem::path& path);

}  // namespace tsar
