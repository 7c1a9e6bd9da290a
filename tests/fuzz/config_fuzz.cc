// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/image_lists.h"

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

// Three images in a row that see the same points.
SparseModel MakeModel() {
  SparseModel model;
  for (int i = 0; i < 20; ++i) {
    model.points.push_back({0.1 * i, 0.2 * i, 5.0});
  }
  for (const char* name : {"a.png", "left/b.png", "c.png"}) {
    SparseModel::ModelImage image;
    image.name = name;
    image.camera.translation.x() = -static_cast<double>(model.images.size());
    for (int i = 0; i < 20; ++i) {
      image.point_indices.push_back(i);
    }
    model.images.push_back(std::move(image));
  }
  model.IndexNames();
  return model;
}

void ReadConfigs(std::span<const uint8_t> input) {
  static const SparseModel model = MakeModel();
  const std::filesystem::path path = PutFile("some.cfg", input);
  Accepts([&] { ReadPatchMatchConfig(path, model); });
}

std::vector<std::string> MakeConfigSeeds() {
  return {
      "# a comment\na.png\n__all__\nleft/b.png\n__auto__, 20\n"
      "c.png\na.png, left/b.png\n",
      "a.png\nc.png; left/b.png\r\n",
      "a.png\nleft/b.png\nc.png\n"};
}

void ReadList(std::span<const uint8_t> input) {
  static const SparseModel model = MakeModel();
  const std::filesystem::path path = PutFile("list.txt", input);
  Accepts([&] { ReadImageList(path, model, "image_list"); });
}

std::vector<std::string> MakeListSeeds() {
  return {"c.png\na.png\n\nleft/b.png\n", "left/b.png\n2333_00000001"};
}

}  // namespace

const FuzzTarget kConfigTarget = {"config", &ReadConfigs, &MakeConfigSeeds};
const FuzzTarget kImageListTarget = {"image_list", &ReadList, &MakeListSeeds};

}  // namespace tsar
