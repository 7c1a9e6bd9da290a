// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/dense_maps.h"

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

// A map as it is taken further.
void Convert(const FloatMap& map) {
  Accepts([&] { ToDepth(map, "map"); });
  Accepts([&] { ToNormals(map, "map"); });
}

void ReadDmb(std::span<const uint8_t> input) {
  Accepts([&] { Convert(ParseDmb(input, "a.dmb")); });
}

void ReadApd(std::span<const uint8_t> input) {
  Accepts([&] { Convert(ParseApdMap(input, "a.bin")); });
}

void ReadDmap(std::span<const uint8_t> input) {
  Accepts([&] { ParseDmap(input, "a.dmap"); });
  Accepts([&] { ParseDmapImageName(input, "a.dmap"); });
}

void ReadCamera(std::span<const uint8_t> input) {
  Accepts([&] { ParseCamFile(input, "00000000_cam.txt"); });
}

// The header's numbers, then floats.
std::string Raster(std::initializer_list<int32_t> header, int num_values) {
  std::string bytes;
  for (const int32_t value : header) {
    AppendValue(value, &bytes);
  }
  for (int i = 0; i < num_values; ++i) {
    AppendValue(0.5f * static_cast<float>(i), &bytes);
  }
  return bytes;
}

std::vector<std::string> MakeDmbSeeds() {
  return {Raster({1, 2, 3, 1}, 6), Raster({1, 2, 2, 3}, 12)};
}

std::vector<std::string> MakeApdSeeds() {
  return {
      Raster({1, 2, 3, 5}, 6), Raster({2, 3, 5}, 6), Raster({1, 2, 2, 21}, 12)};
}

std::vector<std::string> MakeDmapSeeds() {
  std::string bytes = "DR";
  AppendValue(uint8_t{15}, &bytes);
  AppendValue(uint8_t{0}, &bytes);
  for (const uint32_t size : {4u, 4u, 2u, 2u}) {
    AppendValue(size, &bytes);
  }
  AppendValue(1.f, &bytes);
  AppendValue(9.f, &bytes);
  AppendValue(uint16_t{5}, &bytes);
  bytes += "a.png";
  for (const uint32_t number : {2u, 0u, 1u}) {  // How many ids, and these.
    AppendValue(number, &bytes);
  }
  for (const double value : {10., 0., 2., 0., 10., 2., 0., 0., 1.,  // K
                             1.,  0., 0., 0., 1.,  0., 0., 0., 1.,  // R
                             0.,  0., 1.}) {                        // C
    AppendValue(value, &bytes);
  }
  return {bytes + Raster({}, 4 * (1 + 3 + 1 + 1))};
}

std::vector<std::string> MakeCameraSeeds() {
  return {
      "extrinsic\n1 0 0 0.5\n0 1 0 0\n0 0 1 -2e0\n0 0 0 1\n\n"
      "intrinsic\n10 0 4\n0 10 3\n0 0 1\n\n1 0.1 192 20\n"};
}

}  // namespace

const FuzzTarget kDmbTarget = {"dmb", &ReadDmb, &MakeDmbSeeds};
const FuzzTarget kApdTarget = {"apd", &ReadApd, &MakeApdSeeds};
const FuzzTarget kDmapTarget = {"dmap", &ReadDmap, &MakeDmapSeeds};
const FuzzTarget kStoredCameraTarget = {
    "stored_camera", &ReadCamera, &MakeCameraSeeds};

}  // namespace tsar
