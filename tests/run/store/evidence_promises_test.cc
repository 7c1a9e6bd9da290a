// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/evidence_file.h"

#include <functional>
#include <limits>
#include <utility>

#include "tests/run/store/evidence_testing.h"
#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

struct Fault {
  std::string what;
  std::function<void(ViewEvidence*)> make;
};

std::vector<Fault> NeighborFaults() {
  const std::string label = "a label that no superpixel has";
  const std::string camera = "intrinsics that no camera has";
  const std::string noise = "a noise that is no number";
  const std::string weight = "a superpixel's invalid weight";
  const std::string owners = "observations that are not those of";
  const std::string observation = "an invalid observation";
  const std::string kind = "an observation of an unknown kind";
  const std::string plane = "an invalid plane";
  const std::string depth = "an invalid depth";
  return {
      {label, [](auto* e) { e->superpixels(8, 6) = 5; }},
      {label, [](auto* e) { e->superpixels(0, 0) = 65535; }},
      {camera, [](auto* e) { e->intrinsics.fx = 0.f; }},
      {camera, [](auto* e) { e->intrinsics.fx = kNan; }},
      {camera, [](auto* e) { e->intrinsics.fx = kInf; }},
      {camera, [](auto* e) { e->intrinsics.fy = -9.f; }},
      {camera, [](auto* e) { e->intrinsics.fy = kInf; }},
      {camera, [](auto* e) { e->intrinsics.cx = kNan; }},
      {camera, [](auto* e) { e->intrinsics.cx = -kInf; }},
      {camera, [](auto* e) { e->intrinsics.cy = kInf; }},
      {noise, [](auto* e) { e->resolution.error_per_depth = kNan; }},
      {noise, [](auto* e) { e->resolution.error_per_depth = -1.f; }},
      {noise, [](auto* e) { e->noise = kInf; }},
      {noise, [](auto* e) { e->noise = -kInf; }},
      {weight, [](auto* e) { e->weights[4] = kNan; }},
      {weight, [](auto* e) { e->weights[0] = -1.f; }},
      {weight, [](auto* e) { e->weights[0] = kInf; }},
      {owners, [](auto* e) { e->first_observation[0] = 1; }},
      {owners, [](auto* e) { e->first_observation[0] = -1; }},
      {owners, [](auto* e) { e->first_observation[2] = 5; }},
      {owners, [](auto* e) { e->first_observation[3] = -4; }},
      {owners, [](auto* e) { e->first_observation[4] = 12; }},
      {owners, [](auto* e) { e->first_observation[5] = 10; }},
      {owners, [](auto* e) { e->first_observation[5] = 12; }},
      {owners, [](auto* e) { e->first_observation[5] = -1; }},
      {observation, [](auto* e) { e->observations[10].sample.x = kNan; }},
      {observation, [](auto* e) { e->observations[0].sample.y = -kInf; }},
      {observation, [](auto* e) { e->observations[3].sample.z = 0.f; }},
      {observation, [](auto* e) { e->observations[3].sample.z = -1.f; }},
      {observation, [](auto* e) { e->observations[3].sample.z = kInf; }},
      {observation, [](auto* e) { e->observations[3].sample.z = kNan; }},
      {observation, [](auto* e) { e->observations[3].confidence = 0.f; }},
      {observation, [](auto* e) { e->observations[3].confidence = -0.5f; }},
      {observation, [](auto* e) { e->observations[3].confidence = kInf; }},
      {observation, [](auto* e) { e->observations[3].confidence = kNan; }},
      {observation, [](auto* e) { e->errors[0] = 0.f; }},
      {observation, [](auto* e) { e->errors[10] = -1.f; }},
      {observation, [](auto* e) { e->errors[3] = kInf; }},
      {observation, [](auto* e) { e->errors[3] = kNan; }},
      {kind, [](auto* e) { e->sources[10] = ObservationSource(3); }},
      {kind, [](auto* e) { e->sources[0] = ObservationSource(255); }},
      {plane, [](auto* e) { e->candidates[2].normal.x = kNan; }},
      {plane, [](auto* e) { e->candidates[0].normal.y = kInf; }},
      {plane, [](auto* e) { e->candidates[0].normal.z = -kInf; }},
      {plane, [](auto* e) { e->candidates[1].offset = kNan; }},
      {plane, [](auto* e) { e->candidates[1] = Plane(); }},
      {depth, [](auto* e) { e->confident_depth(8, 6) = kNan; }},
      {depth, [](auto* e) { e->confident_depth(0, 0) = kInf; }},
      {depth, [](auto* e) { e->confident_depth(0, 0) = -1.f; }},
  };
}

std::vector<Fault> OwnFaults() {
  const std::string border = "borders that are not those of";
  const std::string prior = "an invalid prior";
  const std::string owners = "confirmed depths that are not those of";
  const std::string confirmed = "an invalid confirmed depth";
  const std::string weight = "a border's invalid weight";
  return {
      {prior, [](auto* e) { e->prior.depth(8, 6) = kNan; }},
      {prior, [](auto* e) { e->prior.depth(0, 0) = kInf; }},
      {prior, [](auto* e) { e->prior.depth(0, 0) = -1.f; }},
      {prior, [](auto* e) { e->prior.sigma(8, 6) = kNan; }},
      {prior, [](auto* e) { e->prior.sigma(0, 0) = kInf; }},
      {prior, [](auto* e) { e->prior.sigma(0, 0) = -1.f; }},
      {prior, [](auto* e) { e->prior.assessment.skill = kNan; }},
      {prior, [](auto* e) { e->prior.outlier_share = 0.f; }},
      {prior, [](auto* e) { e->prior.outlier_share = 1.f; }},
      {prior, [](auto* e) { e->prior.outlier_share = kNan; }},
      {prior, [](auto* e) { e->prior.normals[1].y = kNan; }},
      {prior, [](auto* e) { e->prior.normals.pop_back(); }},
      {prior, [](auto* e) { e->prior.normal_outlier_share = 1.f; }},
      {prior, [](auto* e) { e->prior.assessment.normal_sigma = 0.f; }},
      {prior, [](auto* e) { e->prior.assessment.normal_sigma = kInf; }},
      {owners, [](auto* e) { e->first_confirmed[0] = 1; }},
      {owners, [](auto* e) { e->first_confirmed[1] = -2; }},
      {owners, [](auto* e) { e->first_confirmed[2] = 4; }},
      {owners, [](auto* e) { e->first_confirmed[5] = 3; }},
      {owners, [](auto* e) { e->first_confirmed[5] = 5; }},
      {owners, [](auto* e) { e->confirmed_pixels[2] = -1; }},
      {confirmed, [](auto* e) { e->confirmed[3].x = kNan; }},
      {confirmed, [](auto* e) { e->confirmed[0].y = kInf; }},
      {confirmed, [](auto* e) { e->confirmed[1].z = 0.f; }},
      {confirmed, [](auto* e) { e->confirmed[1].z = kInf; }},
      {border, [](auto* e) { e->borders[0].first = -1; }},
      {border, [](auto* e) { e->borders[3].second = 5; }},
      {border, [](auto* e) { e->borders[1].second = 1; }},
      {border, [](auto* e) { e->borders[3].second = 2; }},
      {border, [](auto* e) { std::swap(e->borders[0], e->borders[1]); }},
      {border, [](auto* e) { e->borders[2].pixels[0] = -1; }},
      {border, [](auto* e) { e->borders[2].pixels[3] = 9 * 7; }},
      {weight, [](auto* e) { e->borders[0].weight = kNan; }},
      {weight, [](auto* e) { e->borders[0].weight = kInf; }},
      {weight, [](auto* e) { e->borders[0].weight = -1.f; }},
  };
}

TEST_F(EvidenceFileTest, RefusesToReadWhatBreaksAPromise) {
  for (const Fault& fault : NeighborFaults()) {
    SCOPED_TRACE(fault.what);
    ViewEvidence evidence = evidence_;
    fault.make(&evidence);
    WriteText(path_, FileBytes(HeaderFields(evidence), evidence));
    ExpectCorrupt(fault.what);
    ExpectCorrupt(fault.what, EvidenceParts::kForNeighbors);
  }
  for (const Fault& fault : OwnFaults()) {
    SCOPED_TRACE(fault.what);
    ViewEvidence evidence = evidence_;
    fault.make(&evidence);
    WriteText(path_, FileBytes(HeaderFields(evidence), evidence));
    ExpectCorrupt(fault.what);
    ExpectSameForNeighbors(ReadEvidence(path_, EvidenceParts::kForNeighbors),
                           evidence);
  }
}

TEST_F(EvidenceFileTest, RefusesToWriteWhatCannotBeRead) {
  WriteText(path_, "old");
  std::vector<Fault> faults = NeighborFaults();
  for (const Fault& fault : OwnFaults()) {
    faults.push_back(fault);
  }
  const std::string sizes = "sizes that do not fit each other";
  faults.push_back({sizes, [](auto* e) { e->width = 0; }});
  faults.push_back({sizes, [](auto* e) { e->weights.pop_back(); }});
  faults.push_back({sizes, [](auto* e) { e->first_observation.clear(); }});
  const std::string owners = "observations that are not those of";
  faults.push_back({owners, [](auto* e) { e->sources.pop_back(); }});
  faults.push_back({owners, [](auto* e) { e->errors.pop_back(); }});
  const std::string prior = "an invalid prior";
  faults.push_back({prior, [](auto* e) { e->prior.sigma = {}; }});
  faults.push_back({prior, [](auto* e) { e->prior.assessment = {}; }});
  faults.push_back(
      {prior, [](auto* e) { e->prior.depth = Image<float>(9, 6, 1.f); }});
  faults.push_back({sizes, [](auto* e) { e->first_confirmed.clear(); }});
  faults.push_back({sizes, [](auto* e) { e->confirmed_pixels.clear(); }});
  faults.push_back({sizes, [](auto* e) { std::swap(e->width, e->height); }});
  faults.push_back({sizes, [](auto* e) { e->superpixels = {}; }});
  faults.push_back({sizes, [](auto* e) { e->confident_depth = {}; }});
  faults.push_back({sizes, [](auto* e) { e->color = {}; }});
  faults.push_back({sizes, [](auto* e) { e->color = Image<Rgb>(9, 6); }});
  faults.push_back({sizes, [](auto* e) { e->flags = {}; }});
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.what);
    ViewEvidence evidence = evidence_;
    fault.make(&evidence);
    ExpectError(ErrorCode::kMismatch, {path_.string(), fault.what}, [&] {
      WriteEvidence(UserPath(path_), kOptionsHash, evidence);
    });
  }
  EXPECT_EQ(ReadText(path_), "old");
}

}  // namespace
}  // namespace tsar
