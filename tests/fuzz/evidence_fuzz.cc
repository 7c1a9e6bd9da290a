// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/evidence_file.h"

#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/signed_file.h"

namespace tsar {
namespace {

// Of the header, see evidence_file.cc.
constexpr size_t kHeaderSize = 160;
constexpr SignedLayout kLayout = {kHeaderSize, 136, 144, 152};

std::vector<uint8_t> SignedEvidence(std::span<const uint8_t> input) {
  // The arrays that neighbors read come first.
  return Signed(input, kLayout, [](const std::vector<uint8_t>& bytes) {
    const size_t num_pixels =
        static_cast<size_t>(ValueAt<uint16_t>(bytes, 16)) *
        ValueAt<uint16_t>(bytes, 20);
    return 9 * num_pixels + 8 * ValueAt<uint16_t>(bytes, 80) + 4 +
           17 * ValueAt<uint16_t>(bytes, 88) +
           4 * ValueAt<uint16_t>(bytes, 96) +
           16 * ValueAt<uint16_t>(bytes, 112);
  });
}

bool ReadBoth(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("evidence.bin", input);
  ReadEvidenceHash(path);
  Accepts([&] { ReadEvidence(path, EvidenceParts::kForNeighbors); });
  return Accepts([&] { ReadEvidence(path, EvidenceParts::kAll); });
}

void Read(std::span<const uint8_t> input) {
  ReadBoth(input);
  ReadBoth(SignedEvidence(input));
}

std::vector<std::string> MakeSeeds() {
  ViewEvidence evidence;
  evidence.width = 3;
  evidence.height = 2;
  evidence.intrinsics = {3.f, 3.f, 1.f, 1.f};
  evidence.resolution.error_per_depth = 0.01f;
  evidence.noise = 0.3f;
  evidence.superpixels = Image<uint16_t>(3, 2, 1);
  evidence.confident_depth = Image<float>(3, 2, 2.f);
  evidence.weights = {1.f, 2.f};
  evidence.first_observation = {0, 0, 1};
  evidence.observations.resize(1);
  evidence.observations[0].sample = {0.f, 0.f, 2.f};
  evidence.observations[0].confidence = 0.5f;
  evidence.sources = {ObservationSource::kMeasured};
  evidence.errors = {2.f};
  evidence.prior.depth = Image<float>(3, 2, 2.f);
  evidence.prior.sigma = Image<float>(3, 2, 0.1f);
  evidence.prior.outlier_share = 0.1f;
  evidence.prior.assessment = {PriorVerdict::kUsed,
                               PriorType::kInverse,
                               0.9f,
                               PriorVerdict::kUsed,
                               0.1f};
  evidence.prior.normals = {{0.f, 0.f, -1.f}, {}};
  evidence.prior.normal_outlier_share = 0.1f;
  evidence.first_confirmed = {0, 1, 1};
  evidence.confirmed = {{0.f, 0.f, 2.f}};
  evidence.confirmed_pixels = {3, 0};
  evidence.candidates.resize(1);
  evidence.candidates[0] = {Vec3f{0.f, 0.f, -1.f}, 2.f};
  evidence.borders.resize(1);
  evidence.borders[0].first = 0;
  evidence.borders[0].second = 1;
  evidence.color = Image<Rgb>(3, 2, {1, 2, 3});
  evidence.flags = Image<uint8_t>(6, 4, 1);
  WriteEvidence(UserPath(FuzzFolder() / "evidence.bin"), "options", evidence);
  const std::string seed = TakeFile("evidence.bin");
  // The layout above is that of the file, or this target would test nothing.
  std::string changed = seed;
  changed[kHeaderSize - 1] ^= 1;
  if (!ReadBoth(SignedEvidence(BytesOf(changed)))) {
    throw std::logic_error("evidence_fuzz.cc knows another layout");
  }
  return {seed};
}

}  // namespace

const FuzzTarget kEvidenceTarget = {"evidence", &Read, &MakeSeeds};

}  // namespace tsar
