// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/map_files.h"

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

template <const char* kName>
void ReadDepthImage(std::span<const uint8_t> input) {
  Accepts([&] { ParseDepthImage(input, kName); });
  Accepts([&] { ParseNormalImage(input, kName); });
}

std::vector<std::string> MakeNpySeeds() {
  std::vector<std::string> seeds;
  for (const auto& [type, num_bytes] : {std::pair("<f4", 24),
                                        std::pair("<f8", 48),
                                        std::pair("<f2", 12),
                                        std::pair("<u2", 12)}) {
    seeds.push_back(NpyHeader(type, "2, 3") +
                    std::string(static_cast<size_t>(num_bytes), '\x3f'));
  }
  return seeds;
}

std::vector<std::string> MakePfmSeeds() {
  return {"Pf\n3 2\n-1.0\n" + std::string(24, '\x3f'),
          "PF 2 1 1\n" + std::string(24, '\x3f')};
}

constexpr char kNpyName[] = "depth.npy";
constexpr char kPfmName[] = "depth.pfm";

}  // namespace

const FuzzTarget kNpyTarget = {"npy", &ReadDepthImage<kNpyName>, &MakeNpySeeds};
const FuzzTarget kPfmTarget = {"pfm", &ReadDepthImage<kPfmName>, &MakePfmSeeds};

}  // namespace tsar
