// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/arithmetic.h"
#include "colmap_tsar/io/map_files.h"
#include "colmap_tsar/io/map_io.h"

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

void Read(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("map.bin", input);
  Accepts([&] { ReadMapSize(path); });
  Accepts([&] { ReadDepthMap(path); });
  Accepts([&] { ReadNormalMap(path); });
  Accepts([&] { ReadPlanarMap(path); });
}

std::vector<std::string> MakeSeeds() {
  std::vector<std::string> seeds;
  WriteDepthMap(UserPath(FuzzFolder() / "map.bin"), Image<float>(4, 3, 2.f));
  seeds.push_back(TakeFile("map.bin"));
  WriteNormalMap(UserPath(FuzzFolder() / "map.bin"),
                 Image<Vec3f>(3, 2, Vec3f{0.f, 0.f, -1.f}));
  seeds.push_back(TakeFile("map.bin"));
  WritePlanarMap(UserPath(FuzzFolder() / "map.bin"),
                 {2, 2, 2, {0.f, 1.f, 2.f, 1.f, 2.f, 2.f, 2.f, 2.f}});
  seeds.push_back(TakeFile("map.bin"));
  return seeds;
}

void ReadSigma(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("sigma.npy", input);
  Accepts([&] { ReadSigmaMap(path); });
}

std::vector<std::string> MakeSigmaSeeds() {
  AtomicFile file(UserPath(FuzzFolder() / "sigma.npy"));
  PutSigmaMap(Image<uint16_t>(4, 3, ToPositiveHalf(0.5f)), &file);
  file.Commit();
  return {TakeFile("sigma.npy")};
}

}  // namespace

const FuzzTarget kMapTarget = {"map", &Read, &MakeSeeds};
const FuzzTarget kSigmaMapTarget = {"sigma_map", &ReadSigma, &MakeSigmaSeeds};

}  // namespace tsar
