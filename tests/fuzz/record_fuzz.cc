// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/shard_record.h"

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

constexpr const char* kShardFile = "observe-1-of-3.json";

void ReadShardFile(std::span<const uint8_t> input) {
  const std::filesystem::path path = PutFile(kShardFile, input);
  Accepts([&] { ReadShardRecord(path); });
}

std::vector<std::string> MakeShardSeeds() {
  ShardRecord record;
  record.version = "0.1.0";
  record.type = "geometric";
  record.options.emplace("filter", "1");
  record.options_hash = "0123456789abcdef";
  record.images_hash = "fedcba9876543210";
  record.pass = "observe";
  record.index = 1;
  record.count = 3;
  record.is_complete = true;
  record.images.push_back({"left/b.png", {}, ""});
  const std::filesystem::path root = FuzzFolder() / "shards";
  std::filesystem::create_directories(root / "stereo");
  WriteShardRecord(root, record);
  const std::filesystem::path path = GetShardPath(root, "observe", 1, 3);
  return {TakeFile(path.lexically_relative(FuzzFolder()).string())};
}

}  // namespace

const FuzzTarget kRecordTarget = {"record", &ReadRecordFile, &MakeRecordSeeds};
const FuzzTarget kShardRecordTarget = {
    "shard_record", &ReadShardFile, &MakeShardSeeds};

}  // namespace tsar
