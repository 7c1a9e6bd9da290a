// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "tests/cuda/observed_room.h"

#include "colmap_tsar/base/random.h"
#include "colmap_tsar/scene/evidence/gather_evidence.h"

#include <cstddef>
#include <cstdint>
#include <utility>

#include "tests/cuda/scenes.h"

namespace tsar {
namespace {

ViewEvidence ObserveView(const SyntheticRoom& room, size_t view) {
  constexpr int kSize = SyntheticRoom::kSuperpixelSize;
  constexpr int kNumColumns = SyntheticRoom::kWidth / kSize;
  const Camera& camera = room.cameras[view];
  const auto seed = static_cast<uint32_t>(view);
  EvidenceInputs inputs;
  inputs.superpixels = Image<int>(camera.width, camera.height);
  inputs.num_superpixels = SyntheticRoom::kNumSuperpixels;
  inputs.superpixel_planes.resize(SyntheticRoom::kNumSuperpixels);
  inputs.samples = Image<RayDepth>(camera.width, camera.height);
  inputs.confirmed_samples = Image<RayDepth>(camera.width, camera.height);
  inputs.texture = RandomImage(camera.width, camera.height, 4.f, 30 + seed);
  inputs.contrast = RandomImage(camera.width, camera.height, 20.f, 40 + seed);
  inputs.intrinsics = camera.GetIntrinsics();
  inputs.resolution.error_per_depth = SyntheticRoom::kErrorPerDepth;
  // Each surface has a color of its own, with noise.
  Image<Rgb> color(camera.width, camera.height);
  Philox random(50, seed, 0);
  std::vector<uint32_t> choices(SyntheticRoom::kNumSuperpixels);
  for (uint32_t& choice : choices) {
    choice = random.NextBelow(16);
  }
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const int superpixel = y / kSize * kNumColumns + x / kSize;
      inputs.superpixels(x, y) = superpixel;
      const uint32_t choice = choices[superpixel];
      const Vec3f ray = inputs.intrinsics.Ray(x, y);
      const auto [surface, distance] = room.Hit(camera, {ray.x, ray.y, 1.0});
      const auto depth = static_cast<float>(distance);
      const auto gray = static_cast<uint8_t>(
          80 + 25 * static_cast<int>(surface) + seed + random.NextBelow(8));
      color(x, y) = {gray, gray, gray};
      if (choice < 4) {
        // Of these, some are confirmed by other views alone.
        inputs.confirmed_samples(x, y) = {
            ray.x, ray.y, choice < 2 ? depth * 1.001f : 0.f};
        continue;
      }
      const float noise = 2.f * random.NextFloat() - 1.f;
      inputs.samples(x, y) = {
          ray.x, ray.y, depth * (1.f + (choice == 4 ? 0.4f : 2e-3f) * noise)};
    }
  }
  ViewEvidence evidence = GatherEvidence(inputs).evidence;
  evidence.color = std::move(color);
  return evidence;
}

}  // namespace

SyntheticRoom RoomWithADisc() {
  const Eigen::Vector3d middle(-0.8, 0.4, 4.0);
  return SyntheticRoom({{PlaneThrough({0.2, 0.1, -1.0}, middle),
                         middle,
                         [middle](const Eigen::Vector3d& point) {
                           return (point - middle).norm() < 0.6;
                         }}});
}

std::vector<ViewEvidence> ObserveInPart(const SyntheticRoom& room) {
  std::vector<ViewEvidence> evidence;
  for (size_t i = 0; i < room.cameras.size(); ++i) {
    evidence.push_back(ObserveView(room, i));
  }
  return evidence;
}

}  // namespace tsar
