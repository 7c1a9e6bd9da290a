// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/evidence_file.h"

#include "colmap_tsar/run/store/state_file.h"

#include <cstdint>
#include <vector>

namespace tsar {
namespace {

// If the sizes are the sums of the fields' sizes, there is no padding.
static_assert(sizeof(Observation) == 16 && sizeof(RayDepth) == 12 &&
              sizeof(SuperpixelBorder) == 28 && sizeof(Plane) == 16 &&
              sizeof(Vec3f) == 12 && sizeof(Rgb) == 3);

// The numbers of a view's evidence beside its arrays.
struct Numbers {
  Intrinsics intrinsics;
  float error_per_depth = 0.f;
  float noise = 0.f;
  float prior_outlier_share = 0.f;
  float prior_skill = 0.f;
  float normal_sigma = 0.f;
  float normal_outlier_share = 0.f;
  PriorVerdict verdict = PriorVerdict::kNone;
  PriorVerdict of_normals = PriorVerdict::kNone;
  PriorType prior_type = PriorType::kAuto;
  uint8_t unused = 0;
};

static_assert(sizeof(Numbers) == 44);

Numbers NumbersOf(const ViewEvidence& evidence) {
  const PriorAssessment& assessment = evidence.prior.assessment;
  return {evidence.intrinsics,
          evidence.resolution.error_per_depth,
          evidence.noise,
          evidence.prior.outlier_share,
          assessment.skill,
          assessment.normal_sigma,
          evidence.prior.normal_outlier_share,
          assessment.verdict,
          assessment.of_normals,
          assessment.type};
}

void SetNumbers(const Numbers& numbers, ViewEvidence* evidence) {
  evidence->intrinsics = numbers.intrinsics;
  evidence->resolution.error_per_depth = numbers.error_per_depth;
  evidence->noise = numbers.noise;
  evidence->prior.outlier_share = numbers.prior_outlier_share;
  evidence->prior.normal_outlier_share = numbers.normal_outlier_share;
  evidence->prior.assessment = {numbers.verdict,
                                numbers.prior_type,
                                numbers.prior_skill,
                                numbers.of_normals,
                                numbers.normal_sigma};
}

// Calls `use` for each array that neighbors need, in the order of the file.
template <typename Evidence>
void ForNeighborArrays(Evidence& evidence, const auto& use) {
  use(evidence.superpixels);
  use(evidence.confident_depth);
  use(evidence.color);
  use(evidence.weights);
  use(evidence.first_observation);
  use(evidence.observations);
  use(evidence.sources);
  use(evidence.errors);
  use(evidence.candidates);
}

// The same for the arrays that only the view itself needs.
template <typename Evidence>
void ForOwnArrays(Evidence& evidence, const auto& use) {
  use(evidence.prior.depth);
  use(evidence.prior.sigma);
  use(evidence.prior.normals);
  use(evidence.first_confirmed);
  use(evidence.confirmed);
  use(evidence.confirmed_pixels);
  use(evidence.borders);
  use(evidence.flags);
}

constexpr StateFileKind kEvidenceFile = {
    {'T', 'S', 'A', 'R', 'V', 'I', 'E', 'W'},
    /*version=*/13,
    "evidence file",
    "no such file",
    "run again without removing files meanwhile"};

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
                   const std::string& key,
                   const ViewEvidence& evidence) {
  const std::vector<Numbers> numbers = {NumbersOf(evidence)};
  StateFileWriter writer;
  const auto add = [&](const auto& array) { writer.Add(array); };
  add(numbers);
  ForNeighborArrays(evidence, add);
  writer.EndPart();
  ForOwnArrays(evidence, add);
  writer.EndPart();
  writer.Write(path, kEvidenceFile, key);
}

ViewEvidence ReadEvidence(const std::filesystem::path& path,
                          EvidenceParts parts) {
  StateFileReader reader(path, kEvidenceFile);
  std::vector<Numbers> numbers;
  ViewEvidence evidence;
  const auto read = [&](auto& array) { reader.Read(&array); };
  read(numbers);
  ForNeighborArrays(evidence, read);
  reader.EndPart();
  if (parts == EvidenceParts::kAll) {
    ForOwnArrays(evidence, read);
    reader.EndPart();
  }
  SetNumbers(numbers.at(0), &evidence);
  evidence.width = evidence.superpixels.Width();
  evidence.height = evidence.superpixels.Height();
  return evidence;
}

std::optional<std::string> ReadEvidenceKey(const std::filesystem::path& path) {
  return ReadStateFileKey(path, kEvidenceFile);
}

}  // namespace tsar
