// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/run/store/evidence_testing.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/random.h"

#include <optional>

namespace tsar {
namespace {

template <typename T>
void AppendAll(const T& values, std::string* bytes) {
  for (const auto& value : values) {
    Append(value, bytes);
  }
}

uint64_t HashOf(const std::string& bytes) {
  ContentHash hash;
  hash.Update(bytes.data(), bytes.size());
  return hash.Value();
}

}  // namespace

ViewEvidence DrawEvidence() {
  constexpr int kNumSuperpixels = 5;
  Philox random(1, 2, 3);
  const auto draw = [&random] { return 1.f - random.NextFloat(); };
  ViewEvidence evidence;
  evidence.width = 9;
  evidence.height = 7;
  evidence.intrinsics = {
      8.f + draw(), 9.f + draw(), 4.f + draw(), 3.f - draw()};
  evidence.resolution.error_per_depth = draw();
  evidence.noise = draw();
  evidence.superpixels = Image<uint16_t>(9, 7);
  evidence.confident_depth = Image<float>(9, 7);
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 9; ++x) {
      evidence.superpixels(x, y) = static_cast<uint16_t>(x / 2);
      evidence.confident_depth(x, y) = y % 2 == 0 ? 10.f * draw() : 0.f;
    }
  }
  // The third superpixel has no observations.
  evidence.first_observation = {0, 3, 4, 4, 9, 11};
  for (int i = 0; i < 11; ++i) {
    evidence.observations.push_back(
        {{draw() - 0.5f, draw() - 0.5f, 10.f * draw()}, draw()});
  }
  for (int i = 0; i < 11; ++i) {
    evidence.sources.push_back(i % 3 == 0 ? ObservationSource::kMeasured
                                          : ObservationSource::kRegionPlane);
    evidence.errors.push_back(1.f + 9.f * draw());
  }
  // The last of a superpixel's observations stands for many of a prior.
  evidence.sources[8] = ObservationSource::kPrior;
  evidence.observations[8].confidence = 2.f + draw();
  evidence.prior.outlier_share = 0.5f * draw();
  evidence.prior.assessment = {PriorVerdict::kUsed,
                               PriorType::kInverse,
                               draw(),
                               PriorVerdict::kUsed,
                               draw()};
  evidence.prior.normal_outlier_share = 0.5f * draw();
  for (int k = 0; k < kNumSuperpixels; ++k) {
    evidence.prior.normals.push_back(k == 2 ? Vec3f{}
                                            : Vec3f{0.f, 0.6f, -0.8f});
  }
  evidence.prior.depth = Image<float>(9, 7);
  evidence.prior.sigma = Image<float>(9, 7);
  for (size_t i = 0; i < evidence.prior.depth.NumPixels(); ++i) {
    const bool has_prior = i % 4 != 0;
    evidence.prior.depth.Data()[i] = has_prior ? 10.f * draw() : 0.f;
    evidence.prior.sigma.Data()[i] = has_prior ? draw() : 0.f;
  }
  evidence.first_confirmed = {0, 2, 2, 3, 3, 4};
  evidence.confirmed_pixels = {5, 0, 1, 0, 7};
  for (int i = 0; i < 4; ++i) {
    evidence.confirmed.push_back({draw() - 0.5f, draw() - 0.5f, 10.f * draw()});
  }
  for (int k = 0; k < kNumSuperpixels; ++k) {
    evidence.weights.push_back(20.f * draw());
  }
  for (int k = 0; k + 1 < kNumSuperpixels; ++k) {
    const int x = 2 * k + 1;
    evidence.borders.push_back(
        {k, k + 1, 7.f * draw(), {x, x + 9, x + 27, x + 27}});
  }
  for (int i = 0; i < 3; ++i) {
    evidence.candidates.push_back({{draw(), draw(), -draw()}, 5.f * draw()});
  }
  evidence.color = Image<Rgb>(9, 7);
  for (Rgb& pixel : evidence.color) {
    const auto level = [&] { return static_cast<uint8_t>(255.f * draw()); };
    pixel = {level(), level(), level()};
  }
  evidence.flags = Image<uint8_t>(13, 11);
  for (uint8_t& flags : evidence.flags) {
    flags = static_cast<uint8_t>(255.f * draw());
  }
  return evidence;
}

std::string NeighborBytes(const ViewEvidence& evidence) {
  std::string bytes;
  AppendAll(evidence.superpixels, &bytes);
  AppendAll(evidence.confident_depth, &bytes);
  for (const Rgb& pixel : evidence.color) {
    Append(pixel.r, &bytes);
    Append(pixel.g, &bytes);
    Append(pixel.b, &bytes);
  }
  AppendAll(evidence.weights, &bytes);
  AppendAll(evidence.first_observation, &bytes);
  for (const Observation& observation : evidence.observations) {
    Append(observation.sample.x, &bytes);
    Append(observation.sample.y, &bytes);
    Append(observation.sample.z, &bytes);
    Append(observation.confidence, &bytes);
  }
  AppendAll(evidence.sources, &bytes);
  AppendAll(evidence.errors, &bytes);
  for (const Plane& plane : evidence.candidates) {
    Append(plane.normal.x, &bytes);
    Append(plane.normal.y, &bytes);
    Append(plane.normal.z, &bytes);
    Append(plane.offset, &bytes);
  }
  return bytes;
}

std::string OwnBytes(const ViewEvidence& evidence) {
  std::string bytes;
  AppendAll(evidence.prior.depth, &bytes);
  AppendAll(evidence.prior.sigma, &bytes);
  for (const Vec3f& normal : evidence.prior.normals) {
    Append(normal.x, &bytes);
    Append(normal.y, &bytes);
    Append(normal.z, &bytes);
  }
  AppendAll(evidence.first_confirmed, &bytes);
  for (const RayDepth& sample : evidence.confirmed) {
    Append(sample.x, &bytes);
    Append(sample.y, &bytes);
    Append(sample.z, &bytes);
  }
  AppendAll(evidence.confirmed_pixels, &bytes);
  for (const SuperpixelBorder& border : evidence.borders) {
    Append(border.first, &bytes);
    Append(border.second, &bytes);
    Append(border.weight, &bytes);
    AppendAll(border.pixels, &bytes);
  }
  AppendAll(evidence.flags, &bytes);
  return bytes;
}

std::string FileBytes(const HeaderFields& fields,
                      const ViewEvidence& evidence) {
  const std::string neighbor_bytes = NeighborBytes(evidence);
  const std::string own_bytes = OwnBytes(evidence);
  std::string bytes = fields.magic;
  Append(fields.version, &bytes);
  Append(fields.options_hash_length, &bytes);
  Append(fields.width, &bytes);
  Append(fields.height, &bytes);
  Append(fields.ratings_width, &bytes);
  Append(fields.ratings_height, &bytes);
  Append(evidence.intrinsics.fx, &bytes);
  Append(evidence.intrinsics.fy, &bytes);
  Append(evidence.intrinsics.cx, &bytes);
  Append(evidence.intrinsics.cy, &bytes);
  Append(evidence.resolution.error_per_depth, &bytes);
  Append(evidence.noise, &bytes);
  Append(evidence.prior.outlier_share, &bytes);
  Append(evidence.prior.assessment.skill, &bytes);
  Append(evidence.prior.assessment.normal_sigma, &bytes);
  Append(evidence.prior.normal_outlier_share, &bytes);
  Append(fields.prior_verdict, &bytes);
  Append(static_cast<uint16_t>(evidence.prior.assessment.of_normals), &bytes);
  Append(static_cast<uint32_t>(evidence.prior.assessment.type), &bytes);
  Append(fields.num_superpixels, &bytes);
  Append(fields.num_observations, &bytes);
  Append(fields.num_errors, &bytes);
  Append(fields.num_confirmed, &bytes);
  Append(fields.num_candidates, &bytes);
  Append(fields.num_borders, &bytes);
  Append(uint64_t{evidence.prior.normals.size()}, &bytes);
  Append(HashOf(neighbor_bytes), &bytes);
  Append(HashOf(own_bytes), &bytes);
  Append(HashOf(bytes + kOptionsHash), &bytes);
  return bytes + kOptionsHash + neighbor_bytes + own_bytes;
}

void ExpectSameForNeighbors(const ViewEvidence& a, const ViewEvidence& b) {
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.intrinsics.fx, b.intrinsics.fx);
  EXPECT_EQ(a.intrinsics.fy, b.intrinsics.fy);
  EXPECT_EQ(a.intrinsics.cx, b.intrinsics.cx);
  EXPECT_EQ(a.intrinsics.cy, b.intrinsics.cy);
  EXPECT_EQ(a.resolution.error_per_depth, b.resolution.error_per_depth);
  EXPECT_EQ(a.noise, b.noise);
  EXPECT_TRUE(a.superpixels.HasSizeOf(b.superpixels));
  EXPECT_TRUE(a.confident_depth.HasSizeOf(b.confident_depth));
  EXPECT_EQ(a.observations.size(), b.observations.size());
  EXPECT_EQ(NeighborBytes(a), NeighborBytes(b));
}

void EvidenceFileTest::ExpectCorrupt(const std::string& what,
                                     EvidenceParts parts) {
  ExpectError(ErrorCode::kCorrupt,
              {path_.string() + ": ",
               what,
               "; delete the folder " + path_.parent_path().string() +
                   " and run again"},
              [&] { ReadEvidence(path_, parts); });
}

void EvidenceFileTest::ExpectCorruptAndNoHash(const std::string& what) {
  ExpectCorrupt(what);
  ExpectCorrupt(what, EvidenceParts::kForNeighbors);
  EXPECT_EQ(ReadEvidenceHash(path_), std::nullopt);
}

}  // namespace tsar
