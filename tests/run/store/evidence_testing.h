// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/store/evidence_file.h"

#include <cstdint>
#include <string>

#include "tests/support/test_workspace.h"

namespace tsar {

inline constexpr const char* kOptionsHash = "0123456789abcdef";

// A raster of 9 x 7 pixels in vertical stripes, with all fields drawn.
ViewEvidence DrawEvidence();

// The two parts of a file as evidence_file.h documents them: what neighbors
// read, and what only the image itself does.
std::string NeighborBytes(const ViewEvidence& evidence);
std::string OwnBytes(const ViewEvidence& evidence);

// What the header says, to be set to something else than the truth.
struct HeaderFields {
  explicit HeaderFields(const ViewEvidence& evidence)
      : width(evidence.width),
        height(evidence.height),
        ratings_width(evidence.flags.Width()),
        ratings_height(evidence.flags.Height()),
        prior_verdict(static_cast<uint16_t>(evidence.prior.assessment.verdict)),
        num_superpixels(evidence.weights.size()),
        num_observations(evidence.observations.size()),
        num_errors(evidence.errors.size()),
        num_confirmed(evidence.confirmed.size()),
        num_candidates(evidence.candidates.size()),
        num_borders(evidence.borders.size()) {}

  std::string magic = "TSARVIEW";
  uint32_t version = 12;
  uint32_t options_hash_length = 16;
  int32_t width;
  int32_t height;
  int32_t ratings_width;
  int32_t ratings_height;
  uint16_t prior_verdict;
  uint64_t num_superpixels;
  uint64_t num_observations;
  uint64_t num_errors;
  uint64_t num_confirmed;
  uint64_t num_candidates;
  uint64_t num_borders;
};

// The bytes of a file whose fingerprints are right, whatever it says.
std::string FileBytes(const HeaderFields& fields, const ViewEvidence& evidence);

// Expects the same of what neighbors read.
void ExpectSameForNeighbors(const ViewEvidence& a, const ViewEvidence& b);

class EvidenceFileTest : public testing::Test {
 protected:
  void ExpectCorrupt(const std::string& what,
                     EvidenceParts parts = EvidenceParts::kAll);
  void ExpectCorruptAndNoHash(const std::string& what);

  TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.Path() / "left" / "b.png.bin";
  const ViewEvidence evidence_ = DrawEvidence();
};

}  // namespace tsar
