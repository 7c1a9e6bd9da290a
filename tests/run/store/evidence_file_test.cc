// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/evidence_file.h"

#include <limits>
#include <utility>

#include "tests/run/store/evidence_testing.h"
#include "tests/support/test_workspace.h"
#include <sys/stat.h>

namespace tsar {
namespace {

void ExpectSame(const ViewEvidence& a, const ViewEvidence& b) {
  ExpectSameForNeighbors(a, b);
  EXPECT_EQ(a.borders.size(), b.borders.size());
  EXPECT_TRUE(a.color.HasSizeOf(b.color));
  EXPECT_TRUE(a.flags.HasSizeOf(b.flags));
  EXPECT_TRUE(a.prior.depth.HasSizeOf(b.prior.depth));
  EXPECT_TRUE(a.prior.sigma.HasSizeOf(b.prior.sigma));
  EXPECT_EQ(a.prior.outlier_share, b.prior.outlier_share);
  EXPECT_EQ(a.prior.assessment.verdict, b.prior.assessment.verdict);
  EXPECT_EQ(a.prior.assessment.type, b.prior.assessment.type);
  EXPECT_EQ(a.prior.assessment.skill, b.prior.assessment.skill);
  EXPECT_EQ(a.sources, b.sources);
  EXPECT_EQ(a.errors, b.errors);
  EXPECT_EQ(OwnBytes(a), OwnBytes(b));
}

TEST_F(EvidenceFileTest, LiesInTheFolderOfThisProgram) {
  EXPECT_EQ(
      GetEvidencePath("dense", "left/1.jpg", MapType::kPhotometric).Path(),
      "dense/stereo/tsar/evidence/left/1.jpg.photometric.bin");
}

TEST_F(EvidenceFileTest, WritesTheDocumentedBytes) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  EXPECT_EQ(ReadText(path_), FileBytes(HeaderFields(evidence_), evidence_));
}

TEST_F(EvidenceFileTest, ReadsWhatWasWritten) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  ExpectSame(ReadEvidence(path_), evidence_);
  EXPECT_EQ(ReadEvidenceHash(path_), kOptionsHash);
}

TEST_F(EvidenceFileTest, KeepsThatThereIsNoPrior) {
  ViewEvidence evidence = evidence_;
  evidence.errors.clear();
  evidence.prior = {};
  WriteEvidence(UserPath(path_), kOptionsHash, evidence);
  EXPECT_EQ(ReadText(path_), FileBytes(HeaderFields(evidence), evidence));
  const ViewEvidence read = ReadEvidence(path_);
  ExpectSame(read, evidence);
  EXPECT_TRUE(read.errors.empty());
  EXPECT_TRUE(read.prior.Empty());
}

TEST_F(EvidenceFileTest, ReadsForNeighborsWithoutTheRest) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  const ViewEvidence read = ReadEvidence(path_, EvidenceParts::kForNeighbors);
  ExpectSameForNeighbors(read, evidence_);
  EXPECT_TRUE(read.borders.empty());
  EXPECT_TRUE(read.prior.Empty());
  EXPECT_TRUE(read.flags.Empty());
}

// A view without texture: nothing but one superpixel.
TEST_F(EvidenceFileTest, KeepsEvidenceOfNothing) {
  ViewEvidence nothing;
  nothing.width = 1;
  nothing.height = 2;
  nothing.superpixels = Image<uint16_t>(1, 2);
  nothing.weights = {0.f};
  nothing.first_observation = {0, 0};
  nothing.first_confirmed = {0, 0};
  nothing.confirmed_pixels = {0};
  nothing.confident_depth = Image<float>(1, 2);
  nothing.color = Image<Rgb>(1, 2);
  nothing.flags = Image<uint8_t>(1, 2);
  WriteEvidence(UserPath(path_), "", nothing);
  ExpectSame(ReadEvidence(path_), nothing);
  EXPECT_EQ(ReadEvidenceHash(path_), "");
}

TEST_F(EvidenceFileTest, KeepsTheLimitsOfWhatIsAllowed) {
  ViewEvidence evidence = evidence_;
  evidence.observations[0].confidence = std::numeric_limits<float>::max();
  evidence.observations[1].confidence =
      std::numeric_limits<float>::denorm_min();
  evidence.observations[2].sample.z = std::numeric_limits<float>::max();
  evidence.borders.back().second = 4;
  evidence.borders.back().pixels[3] = 9 * 7 - 1;
  evidence.borders.front().pixels[0] = 0;
  evidence.resolution.error_per_depth = 0.f;
  evidence.noise = 0.f;
  evidence.intrinsics = {std::numeric_limits<float>::denorm_min(),
                         std::numeric_limits<float>::max(),
                         -std::numeric_limits<float>::max(),
                         0.f};
  WriteEvidence(UserPath(path_), kOptionsHash, evidence);
  ExpectSame(ReadEvidence(path_), evidence);
}

TEST_F(EvidenceFileTest, NamesMissingFiles) {
  ExpectError(
      ErrorCode::kNotFound, {path_.string()}, [&] { ReadEvidence(path_); });
  EXPECT_EQ(ReadEvidenceHash(path_), std::nullopt);
}

TEST_F(EvidenceFileTest, RefusesWhatIsNoFile) {
  std::filesystem::create_directories(path_);
  ExpectCorruptAndNoHash("not a regular file");
  std::filesystem::remove(path_);
  // Opening a pipe would wait for ever.
  ASSERT_EQ(mkfifo(path_.c_str(), 0600), 0);
  ExpectCorruptAndNoHash("not a regular file");
}

TEST_F(EvidenceFileTest, RefusesEmptyAndOtherFiles) {
  WriteText(path_, "");
  ExpectCorruptAndNoHash("not complete");
  WriteText(path_, "3&2&1&" + std::string(200, '\0'));
  ExpectCorruptAndNoHash("another kind of file");
}

TEST_F(EvidenceFileTest, NamesTheVersionOfAnotherFormat) {
  HeaderFields fields(evidence_);
  for (const uint32_t version : {0u, 11u, 13u}) {
    fields.version = version;
    const std::string bytes = FileBytes(fields, evidence_);
    // Other versions may have a shorter header.
    for (const size_t length : {bytes.size(), size_t{40}}) {
      WriteText(path_, bytes.substr(0, length));
      ExpectCorruptAndNoHash("version " + std::to_string(version) +
                             ", this program reads version 12");
    }
  }
}

TEST_F(EvidenceFileTest, RefusesFilesOfAnotherLength) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  const std::string good = ReadText(path_);
  ASSERT_GT(good.size(), 1000u);
  for (size_t length = 0; length < good.size(); length += 97) {
    SCOPED_TRACE(length);
    WriteText(path_, good.substr(0, length));
    // The header's 160 bytes, the 16 of the options hash, the arrays.
    ExpectCorruptAndNoHash(length < 160   ? "not complete"
                           : length < 176 ? "cut off"
                                          : "not what the header says");
  }
  for (const std::string& more : {std::string("x"), good}) {
    WriteText(path_, good + more);
    ExpectCorruptAndNoHash("not what the header says");
  }
}

TEST_F(EvidenceFileTest, SeesEveryChangedByte) {
  WriteEvidence(UserPath(path_), kOptionsHash, evidence_);
  const std::string good = ReadText(path_);
  const size_t own_begin = good.size() - OwnBytes(evidence_).size();
  const size_t header_end = own_begin - NeighborBytes(evidence_).size();
  for (size_t i = 0; i < good.size(); ++i) {
    SCOPED_TRACE(i);
    for (const int flip : {0x01, 0x80}) {
      std::string bytes = good;
      bytes[i] = static_cast<char>(bytes[i] ^ flip);
      WriteText(path_, bytes);
      ExpectCorrupt("not a usable evidence file");
      EXPECT_EQ(ReadEvidenceHash(path_).has_value(), i >= header_end);
      if (i < own_begin) {
        ExpectCorrupt("not a usable evidence file",
                      EvidenceParts::kForNeighbors);
      } else {
        ExpectSameForNeighbors(
            ReadEvidence(path_, EvidenceParts::kForNeighbors), evidence_);
      }
    }
  }
}

// Products of these numbers wrap around to small sizes in 32 and 64 bits, or
// would need more memory than there is.
TEST_F(EvidenceFileTest, RefusesAbsurdSizesBeforeAllocating) {
  constexpr int32_t kMaxInt = std::numeric_limits<int32_t>::max();
  constexpr uint64_t kMax = std::numeric_limits<uint64_t>::max();
  const std::vector<std::function<void(HeaderFields*)>> lies = {
      [](auto* f) { f->width = kMaxInt; },
      [](auto* f) { f->width = f->height = kMaxInt; },
      [](auto* f) { f->width = f->height = 65536; },
      [](auto* f) { f->width = 0; },
      [](auto* f) { f->height = 0; },
      [](auto* f) { f->width = -9; },
      [](auto* f) { f->width = -9, f->height = -7; },
      [](auto* f) { f->height = std::numeric_limits<int32_t>::min(); },
      [](auto* f) { f->width = 10; },
      [](auto* f) { f->ratings_width = 0; },
      [](auto* f) { f->ratings_height = -1; },
      [](auto* f) { f->ratings_width = f->ratings_height = kMaxInt; },
      [](auto* f) { f->ratings_width = -13, f->ratings_height = -11; },
      [](auto* f) { f->num_superpixels = kMax; },
      [](auto* f) { f->num_superpixels = kMax / 4 + 1; },
      [](auto* f) { f->num_superpixels = 0; },
      [](auto* f) { f->num_observations = kMax; },
      [](auto* f) { f->num_observations = (kMax >> 4) + 1; },
      [](auto* f) { f->num_observations += kMax / 16 + 1; },
      [](auto* f) { f->num_errors = kMax; },
      [](auto* f) { f->num_errors = kMax / 4 + 1; },
      [](auto* f) { f->num_errors = 0; },
      [](auto* f) { f->prior_verdict = 0; },
      [](auto* f) { f->prior_verdict = 2; },
      [](auto* f) { f->num_confirmed = kMax; },
      [](auto* f) { f->num_confirmed = kMax / 12 + 1; },
      [](auto* f) { f->num_candidates = kMax / 16 + 1; },
      [](auto* f) { f->num_candidates = uint64_t{1} << 32; },
      [](auto* f) { f->num_borders = kMax; },
      [](auto* f) { f->num_borders = 0; },
  };
  for (size_t i = 0; i < lies.size(); ++i) {
    SCOPED_TRACE(i);
    HeaderFields fields(evidence_);
    lies[i](&fields);
    WriteText(path_, FileBytes(fields, evidence_));
    ExpectCorruptAndNoHash("not what the header says");
  }
  for (const auto& [width, height] : {std::pair(0, 5), std::pair(5, 0)}) {
    ViewEvidence evidence = evidence_;
    evidence.flags = Image<uint8_t>(width, height);
    WriteText(path_, FileBytes(HeaderFields(evidence), evidence));
    ExpectCorruptAndNoHash("not what the header says");
  }
  HeaderFields fields(evidence_);
  fields.options_hash_length = std::numeric_limits<uint32_t>::max();
  WriteText(path_, FileBytes(fields, evidence_));
  ExpectCorruptAndNoHash("its header was changed, or it was cut off");
}

// Sizes that fill the file, but not with what belongs there.
TEST_F(EvidenceFileTest, RefusesCountsThatOnlyFitTheLength) {
  // Twelve observations take as many bytes as twelve planes, and their sources
  // as many as three errors.
  ViewEvidence evidence = evidence_;
  evidence.candidates.resize(15, evidence.candidates[0]);
  HeaderFields fields(evidence);
  fields.num_observations += 12;
  fields.num_candidates -= 12;
  fields.num_errors -= 3;
  WriteText(path_, FileBytes(fields, evidence));
  ExpectCorrupt("observations that are not those of the superpixels");
}

}  // namespace
}  // namespace tsar
