// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/output_workspace.h"
#include "colmap_tsar/run/store/record.h"

#include <sstream>

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

void ReadRecordFile(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("record.json", input);
  Accepts([&] { ReadRecord(path); });
}

std::vector<std::string> MakeRecordSeeds() {
  ImageRecord record;
  record.version = "0.1.0";
  record.image = "left/b.png";
  record.type = "geometric";
  record.status = ImageStatus::kDone;
  record.options_hash = "0123456789abcdef";
  record.inputs.emplace("photo", "fedcba9876543210");
  record.depth.written = {{1, 2, {0, ~uint32_t{0}}}, {~uint64_t{0}, -1, {}}};
  record.normal.written = {{2, 0, {}}};
  record.counts["measured"] = 12;
  record.seconds["read"] = 0.5;
  WriteRecord(UserPath(FuzzFolder() / "record.json"), record);
  return {TakeFile("record.json")};
}

void ReadMarker(std::span<const uint8_t> input) {
  std::filesystem::create_directories(FuzzFolder() / "output/stereo/tsar");
  PutFile("output/stereo/tsar/output_of.json", input);
  Accepts([&] { ReadOutputMarker(FuzzFolder() / "output"); });
}

std::vector<std::string> MakeMarkerSeeds() {
  return {R"({"input": "/home/user/dense", "version": "0.1.0"})"};
}

}  // namespace

const FuzzTarget kRecordTarget = {"record", &ReadRecordFile, &MakeRecordSeeds};
const FuzzTarget kOutputMarkerTarget = {
    "output_marker", &ReadMarker, &MakeMarkerSeeds};

}  // namespace tsar
