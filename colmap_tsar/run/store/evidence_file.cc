// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/evidence_file.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/run/store/evidence_fault.h"
#include "colmap_tsar/run/store/state_file.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tsar {
namespace {

// If the sizes are the sums of the fields' sizes, there is no padding.
static_assert(sizeof(Observation) == 16 && sizeof(RayDepth) == 12 &&
              sizeof(SuperpixelBorder) == 28 && sizeof(Plane) == 16 &&
              sizeof(Vec3f) == 12 && sizeof(Rgb) == 3 &&
              sizeof(Intrinsics) == 16);

struct Header {
  StateFileStart start;
  int32_t width = 0;
  int32_t height = 0;
  int32_t flags_width = 0;
  int32_t flags_height = 0;
  Intrinsics intrinsics;
  float error_per_depth = 0.f;
  float noise = 0.f;
  float prior_outlier_share = 0.f;
  float prior_skill = 0.f;
  float normal_sigma = 0.f;
  float normal_outlier_share = 0.f;
  uint16_t prior_verdict = 0;  // PriorVerdicts.
  uint16_t normal_verdict = 0;
  uint32_t prior_type = 0;  // A PriorType.
  uint64_t num_superpixels = 0;
  uint64_t num_observations = 0;
  uint64_t num_errors = 0;
  uint64_t num_confirmed = 0;
  uint64_t num_candidates = 0;
  uint64_t num_borders = 0;
  uint64_t num_normals = 0;
  uint64_t neighbor_fingerprint = 0;
  uint64_t own_fingerprint = 0;
  uint64_t header_fingerprint = 0;

  bool HasPriorDepth() const {
    return prior_verdict == static_cast<uint16_t>(PriorVerdict::kUsed);
  }
  // The sizes in the order of NeighborArrays() and OwnArrays().
  std::vector<StateFileArray> Arrays() const {
    if (width < 1 || height < 1 || flags_width < 1 || flags_height < 1) {
      return {};
    }
    const auto area = [](int32_t columns, int32_t rows) {
      return static_cast<uint64_t>(columns) * static_cast<uint64_t>(rows);
    };
    const uint64_t num_pixels = area(width, height);
    const uint64_t num_flags = area(flags_width, flags_height);
    const uint64_t num_prior_pixels = HasPriorDepth() ? num_pixels : 0;
    return {{num_pixels, sizeof(uint16_t)},
            {num_pixels, sizeof(float)},
            {num_pixels, sizeof(Rgb)},
            {num_superpixels, sizeof(float)},
            {num_superpixels, sizeof(int)},
            {1, sizeof(int)},
            {num_observations, sizeof(Observation)},
            {num_observations, sizeof(ObservationSource)},
            {num_errors, sizeof(float)},
            {num_candidates, sizeof(Plane)},
            {num_prior_pixels, sizeof(float)},
            {num_prior_pixels, sizeof(float)},
            {num_normals, sizeof(Vec3f)},
            {num_superpixels, sizeof(int)},
            {1, sizeof(int)},
            {num_confirmed, sizeof(RayDepth)},
            {num_superpixels, sizeof(int)},
            {num_borders, sizeof(SuperpixelBorder)},
            {num_flags, sizeof(uint8_t)}};
  }
};
static_assert(sizeof(Header) == 160);

// The arrays for writing and for reading.
template <typename Evidence>
auto NeighborArrays(Evidence& evidence) {
  return std::vector{BytesOf(evidence.superpixels),
                     BytesOf(evidence.confident_depth),
                     BytesOf(evidence.color),
                     BytesOf(evidence.weights),
                     BytesOf(evidence.first_observation),
                     BytesOf(evidence.observations),
                     BytesOf(evidence.sources),
                     BytesOf(evidence.errors),
                     BytesOf(evidence.candidates)};
}
template <typename Evidence>
auto OwnArrays(Evidence& evidence) {
  return std::vector{BytesOf(evidence.prior.depth),
                     BytesOf(evidence.prior.sigma),
                     BytesOf(evidence.prior.normals),
                     BytesOf(evidence.first_confirmed),
                     BytesOf(evidence.confirmed),
                     BytesOf(evidence.confirmed_pixels),
                     BytesOf(evidence.borders),
                     BytesOf(evidence.flags)};
}

Error MissingEvidence(const std::filesystem::path& path) {
  return Error::File(ErrorCode::kNotFound,
                     path.string(),
                     "no such file",
                     "run again without removing files meanwhile");
}

Error CorruptEvidence(const std::filesystem::path& path,
                      const std::string& what) {
  return Error::File(
      ErrorCode::kCorrupt,
      path.string(),
      "not a usable evidence file: " + what,
      "delete the folder " + path.parent_path().string() + " and run again");
}

constexpr StateFileKind kEvidenceFile = {
    {'T', 'S', 'A', 'R', 'V', 'I', 'E', 'W'},
    /*version=*/12,
    &MissingEvidence,
    &CorruptEvidence};

PriorAssessment AssessmentOf(const Header& header,
                             const std::filesystem::path& path) {
  constexpr auto kLast = static_cast<uint16_t>(PriorVerdict::kOthersUnlike);
  if (header.prior_verdict > kLast || header.normal_verdict > kLast ||
      header.prior_type > static_cast<uint32_t>(PriorType::kInverse)) {
    throw CorruptEvidence(path, "it has an invalid prior");
  }
  return {static_cast<PriorVerdict>(header.prior_verdict),
          static_cast<PriorType>(header.prior_type),
          header.prior_skill,
          static_cast<PriorVerdict>(header.normal_verdict),
          header.normal_sigma};
}

}  // namespace

ContainedPath GetEvidenceFolder(const std::filesystem::path& root) {
  return GetTsarFolder(root) / "evidence";
}

ContainedPath GetEvidencePath(const std::filesystem::path& root,
                              const std::string& image_name,
                              MapType type) {
  return GetEvidenceFolder(root) / (image_name + "." + ToString(type) + ".bin");
}

void WriteEvidence(const ContainedPath& path,
                   const std::string& options_hash,
                   const ViewEvidence& evidence) {
  RequireNoFault(path, FindEvidenceFault(evidence, EvidenceParts::kAll));
  const ReadableArrays neighbor_arrays = NeighborArrays(evidence);
  const ReadableArrays own_arrays = OwnArrays(evidence);
  Header header;
  header.width = evidence.width;
  header.height = evidence.height;
  header.flags_width = evidence.flags.Width();
  header.flags_height = evidence.flags.Height();
  header.intrinsics = evidence.intrinsics;
  header.error_per_depth = evidence.resolution.error_per_depth;
  header.noise = evidence.noise;
  const PriorAssessment& assessment = evidence.prior.assessment;
  header.prior_outlier_share = evidence.prior.outlier_share;
  header.prior_skill = assessment.skill;
  header.normal_sigma = assessment.normal_sigma;
  header.normal_outlier_share = evidence.prior.normal_outlier_share;
  header.prior_verdict = static_cast<uint16_t>(assessment.verdict);
  header.normal_verdict = static_cast<uint16_t>(assessment.of_normals);
  header.prior_type = static_cast<uint32_t>(assessment.type);
  header.num_superpixels = evidence.weights.size();
  header.num_errors = evidence.errors.size();
  header.num_observations = evidence.observations.size();
  header.num_confirmed = evidence.confirmed.size();
  header.num_candidates = evidence.candidates.size();
  header.num_borders = evidence.borders.size();
  header.num_normals = evidence.prior.normals.size();
  header.neighbor_fingerprint = FingerprintOfArrays(neighbor_arrays);
  header.own_fingerprint = FingerprintOfArrays(own_arrays);
  WriteStateFile(
      path, kEvidenceFile, header, options_hash, {neighbor_arrays, own_arrays});
}

ViewEvidence ReadEvidence(const std::filesystem::path& path,
                          EvidenceParts parts) {
  StateFileReader<Header> reader(path, kEvidenceFile);
  const Header& header = reader.GetHeader();
  const int width = header.width;
  const int height = header.height;
  ViewEvidence evidence;
  evidence.width = width;
  evidence.height = height;
  evidence.intrinsics = header.intrinsics;
  evidence.resolution.error_per_depth = header.error_per_depth;
  evidence.noise = header.noise;
  evidence.superpixels = Image<uint16_t>::Uninitialized(width, height);
  evidence.confident_depth = Image<float>::Uninitialized(width, height);
  evidence.color = Image<Rgb>::Uninitialized(width, height);
  evidence.weights.resize(header.num_superpixels);
  evidence.first_observation.resize(header.num_superpixels + 1);
  evidence.observations.resize(header.num_observations);
  evidence.sources.resize(header.num_observations);
  evidence.errors.resize(header.num_errors);
  evidence.candidates.resize(header.num_candidates);
  reader.Read(NeighborArrays(evidence), header.neighbor_fingerprint);
  if (parts == EvidenceParts::kAll) {
    evidence.prior.assessment = AssessmentOf(header, path);
    evidence.prior.normal_outlier_share = header.normal_outlier_share;
    evidence.prior.normals.resize(header.num_normals);
    if (header.HasPriorDepth()) {
      evidence.prior.outlier_share = header.prior_outlier_share;
      evidence.prior.depth = Image<float>::Uninitialized(width, height);
      evidence.prior.sigma = Image<float>::Uninitialized(width, height);
    }
    evidence.first_confirmed.resize(header.num_superpixels + 1);
    evidence.confirmed.resize(header.num_confirmed);
    evidence.confirmed_pixels.resize(header.num_superpixels);
    evidence.borders.resize(header.num_borders);
    evidence.flags =
        Image<uint8_t>::Uninitialized(header.flags_width, header.flags_height);
    reader.Read(OwnArrays(evidence), header.own_fingerprint);
  }
  if (const auto fault = FindEvidenceFault(evidence, parts)) {
    throw CorruptEvidence(path, "it has " + *fault);
  }
  return evidence;
}

PriorAssessment ReadPriorAssessment(const std::filesystem::path& path) {
  return AssessmentOf(StateFileReader<Header>(path, kEvidenceFile).GetHeader(),
                      path);
}

std::optional<std::string> ReadEvidenceHash(const std::filesystem::path& path) {
  return ReadStateFileHash<Header>(path, kEvidenceFile);
}

}  // namespace tsar
