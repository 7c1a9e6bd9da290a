// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/evidence_file.h"

#include <cstddef>
#include <type_traits>
#include <vector>

namespace tsar {
namespace {

// If the sizes are the sums of the fields' sizes, there is no padding.
static_assert(sizeof(Observation) == 16 && sizeof(RayDepth) == 12 &&
              sizeof(SuperpixelBorder) == 28 && sizeof(Plane) == 16 &&
              sizeof(Vec3f) == 12 && sizeof(Rgb) == 3);

// Calls `use` for each number of a view's evidence besides its arrays, in the
// order of the file.
template <typename Evidence>
void ForNumbers(Evidence& evidence, const auto& use) {
  use(evidence.intrinsics.fx);
  use(evidence.intrinsics.fy);
  use(evidence.intrinsics.cx);
  use(evidence.intrinsics.cy);
  use(evidence.resolution.error_per_depth);
  use(evidence.noise);
  use(evidence.prior.outlier_share);
  use(evidence.prior.normal_outlier_share);
  auto& assessment = evidence.prior.assessment;
  use(assessment.verdict);
  use(assessment.type);
  use(assessment.skill);
  use(assessment.of_normals);
  use(assessment.normal_sigma);
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
  use(evidence.gray);
  use(evidence.flags);
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
                   const std::string& key,
                   const ViewEvidence& evidence) {
  std::vector<float> numbers;
  ForNumbers(evidence, [&](const auto& number) {
    numbers.push_back(static_cast<float>(number));
  });
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
  std::vector<float> numbers;
  ViewEvidence evidence;
  const auto read = [&](auto& array) { reader.Read(&array); };
  read(numbers);
  ForNeighborArrays(evidence, read);
  reader.EndPart();
  if (parts == EvidenceParts::kAll) {
    ForOwnArrays(evidence, read);
    reader.EndPart();
  }
  size_t next = 0;
  ForNumbers(evidence, [&](auto& number) {
    number = static_cast<std::remove_reference_t<decltype(number)>>(
        numbers.at(next++));
  });
  evidence.width = evidence.superpixels.Width();
  evidence.height = evidence.superpixels.Height();
  return evidence;
}

}  // namespace tsar
