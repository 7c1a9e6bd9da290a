// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/scene_model_file.h"

#include <stdexcept>

#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/signed_file.h"

namespace tsar {
namespace {

// Of the header, see scene_model_file.cc.
constexpr size_t kHeaderSize = 80;
constexpr SignedLayout kLayout = {kHeaderSize, 56, 64, 72};
constexpr size_t kPlaneSize = 200;
constexpr size_t kFrameSize = 72;
constexpr size_t kCylinderSize = 168;

std::vector<uint8_t> SignedModel(std::span<const uint8_t> input) {
  return Signed(input, kLayout, [](const std::vector<uint8_t>& bytes) {
    return kPlaneSize * ValueAt<uint16_t>(bytes, 16) +
           kFrameSize * ValueAt<uint16_t>(bytes, 24) +
           kCylinderSize * ValueAt<uint16_t>(bytes, 32);
  });
}

bool ReadBoth(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("planes.bin", input);
  ReadSceneModelHash(path);
  Accepts([&] { ReadSceneModel(path, SceneModelParts::kWithoutLabels); });
  return Accepts([&] { ReadSceneModel(path); });
}

void Read(std::span<const uint8_t> input) {
  ReadBoth(input);
  ReadBoth(SignedModel(input));
}

std::vector<std::string> MakeSeeds() {
  SceneModel model;
  model.frames.push_back(Eigen::Matrix3d::Identity());
  model.planes.resize(2);
  model.planes[1].frame = 0;
  model.planes[1].axis = 2;
  model.cylinders.emplace_back();
  model.cylinders[0].max_height = 1.0;
  model.views[0] = {{0, -1},
                    {LabelEvidence::kMeasured, LabelEvidence::kNone},
                    std::vector<LabelQuality>(2)};
  model.views[4] = {
      {1}, {LabelEvidence::kGuessed}, std::vector<LabelQuality>(1)};
  WriteSceneModel(UserPath(FuzzFolder() / "planes.bin"), "options", model);
  const std::string seed = TakeFile("planes.bin");
  // The layout above is that of the file, or this target would test nothing.
  std::string changed = seed;
  changed[kHeaderSize - 1] ^= 1;
  if (!ReadBoth(SignedModel(BytesOf(changed)))) {
    throw std::logic_error("scene_model_fuzz.cc knows another layout");
  }
  return {seed};
}

}  // namespace

const FuzzTarget kSceneModelTarget = {"scene_model", &Read, &MakeSeeds};

}  // namespace tsar
