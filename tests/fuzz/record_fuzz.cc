// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/record.h"

#include "tests/fuzz/fuzz_target.h"

namespace tsar {
namespace {

void ReadRecordFile(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile("record.json", input);
  Accepts([&] { ReadRecord(path); });
}

std::vector<std::string> MakeRecordSeeds() {
  ImageRecord record;
  record.image = "left/b.png";
  record.type = "geometric";
  record.status = ImageStatus::kDone;
  record.options_hash = "0123456789abcdef";
  record.inputs = "fedcba9876543210";
  record.files["depth"] = {{1, 2, 3}, {~uint64_t{0}, -1, 0}};
  record.counts["measured"] = 12;
  record.seconds["read"] = 0.5;
  WriteRecord(UserPath(FuzzFolder() / "record.json"), record);
  return {TakeFile("record.json")};
}

}  // namespace

const FuzzTarget kRecordTarget = {"record", &ReadRecordFile, &MakeRecordSeeds};

}  // namespace tsar
