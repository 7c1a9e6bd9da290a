// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/scene_model_file.h"

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

// Of the header, see scene_model_file.cc.
void Read(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("planes.bin", input);
  ReadSceneModelKey(path);
  Accepts([&] { ReadSceneModel(path, SceneModelParts::kWithoutLabels); });
  Accepts([&] { ReadSceneModel(path); });
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
  return {TakeFile("planes.bin")};
}

}  // namespace

const FuzzTarget kSceneModelTarget = {"scene_model", &Read, &MakeSeeds};

}  // namespace tsar
