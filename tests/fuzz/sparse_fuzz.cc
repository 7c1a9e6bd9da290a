// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/sparse_model.h"

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

// The three files of a model in a folder of their own.
void ReadModel(const std::string& extension, std::span<const uint8_t> input) {
  const std::string folder = "sparse" + extension;
  std::filesystem::create_directories(FuzzFolder() / folder);
  std::vector<std::span<const uint8_t>> files = SplitFiles(input);
  files.resize(3);
  PutFile(folder + "/cameras" + extension, files[0]);
  PutFile(folder + "/images" + extension, files[1]);
  PutFile(folder + "/points3D" + extension, files[2]);
  Accepts([&] { ReadSparseModel(FuzzFolder() / folder); });
}

void ReadBinary(std::span<const uint8_t> input) { ReadModel(".bin", input); }
void ReadText(std::span<const uint8_t> input) { ReadModel(".txt", input); }

template <typename... Values>
void AppendAll(std::string* bytes, Values... values) {
  (AppendValue(values, bytes), ...);
}

std::vector<std::string> MakeBinarySeeds() {
  std::string cameras;
  AppendAll(&cameras, uint64_t{2}, uint32_t{1}, int32_t{1}, uint64_t{8});
  AppendAll(&cameras, uint64_t{6}, 10.0, 10.0, 4.0, 3.0);
  AppendAll(&cameras, uint32_t{2}, int32_t{0}, uint64_t{8}, uint64_t{6});
  AppendAll(&cameras, 10.0, 4.0, 3.0);
  std::string images;
  AppendAll(&images, uint64_t{2});
  for (const uint32_t id : {1u, 2u}) {
    AppendAll(&images, id, 1.0, 0.0, 0.0, 0.0, -1.0 * id, 0.0, 0.0, id);
    images += id == 1 ? "a.png" : "left/b.png";
    AppendAll(&images, '\0', uint64_t{1}, 1.0, 2.0, uint64_t{1});
  }
  std::string points;
  AppendAll(&points, uint64_t{1}, uint64_t{1}, 0.0, 0.0, 5.0);
  points += "rgb";
  AppendAll(&points, 0.5, uint64_t{2}, 1u, 0u, 2u, 0u);
  return {JoinFiles({cameras, images, points})};
}

std::vector<std::string> MakeTextSeeds() {
  return {JoinFiles({"# cameras\n1 PINHOLE 8 6 10 10 4 3\n"
                     "2 SIMPLE_PINHOLE 8 6 10 4 3\n",
                     "1 1 0 0 0 0 0 0 1 a.png\n\n"
                     "2 1 0 0 0 -1 0 0 2 left/b.png\n1.5 2.5 1\n",
                     "1 0 0 5 0 0 0 0.5 1 0 2 0\n"}),
          JoinFiles({"3 OPENCV 8 6 10 10 4 3 0 0 0 0\n", "", ""})};
}

}  // namespace

const FuzzTarget kSparseBinaryTarget = {
    "sparse_binary", &ReadBinary, &MakeBinarySeeds};
const FuzzTarget kSparseTextTarget = {"sparse_text", &ReadText, &MakeTextSeeds};

}  // namespace tsar
