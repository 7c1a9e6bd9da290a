// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/shard_record.h"

#include <functional>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

using State = ShardRecord::State;

ShardRecord MakeRecord(int index) {
  ShardRecord record;
  record.version = "1.2";
  record.type = "geometric";
  record.options = {{"eta", "0.8"}, {"tau", "1"}};
  record.options_hash = "0123";
  record.images_hash = "77";
  record.inputs = "0456";
  record.pass = "observe";
  record.index = index;
  record.count = 3;
  record.is_complete = true;
  record.runtime = {{"host", "here"}};
  record.num_masks = index;
  record.num_priors = index + 1;
  record.images = {
      {"a.png", State::kObserved, ""},
      {"left/b.png", State::kNothing, ""},
      {"c.png", State::kNotNeeded, ""},
      {"d.png", State::kComposed, ""},
      {"e.png", State::kNeeded, "a \"note\""}};
  return record;
}

TEST(ShardRecordTest, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const std::filesystem::path path =
      GetShardPath(folder.Path(), "observe", 2, 3);
  EXPECT_EQ(path, folder.Path() / "stereo/tsar/shards/observe-2-of-3.json");
  ExpectError(
      ErrorCode::kNotFound, {path.string()}, [&] { ReadShardRecord(path); });
  const ShardRecord written = MakeRecord(2);
  WriteShardRecord(folder.Path(), written);
  const ShardRecord read = ReadShardRecord(path);
  EXPECT_EQ(read.version, written.version);
  EXPECT_EQ(read.type, written.type);
  EXPECT_EQ(read.options, written.options);
  EXPECT_EQ(read.options_hash, written.options_hash);
  EXPECT_EQ(read.images_hash, written.images_hash);
  EXPECT_EQ(read.inputs, written.inputs);
  EXPECT_EQ(read.pass, written.pass);
  EXPECT_EQ(read.index, 2);
  EXPECT_EQ(read.count, 3);
  EXPECT_TRUE(read.is_complete);
  EXPECT_EQ(read.runtime, written.runtime);
  EXPECT_EQ(read.num_masks, 2);
  EXPECT_EQ(read.num_priors, 3);
  ASSERT_EQ(read.images.size(), written.images.size());
  for (size_t i = 0; i < read.images.size(); ++i) {
    EXPECT_EQ(read.images[i].image, written.images[i].image);
    EXPECT_EQ(static_cast<int>(read.images[i].state),
              static_cast<int>(written.images[i].state));
    EXPECT_EQ(read.images[i].note, written.images[i].note);
  }
}

TEST(ShardRecordTest, NoMasksAreNotTheSameAsNoneOfItsImages) {
  const TemporaryFolder folder;
  for (std::optional<int64_t> ShardRecord::*count :
       {&ShardRecord::num_masks, &ShardRecord::num_priors}) {
    ShardRecord record = MakeRecord(0);
    for (const std::optional<int64_t>& number :
         {std::optional<int64_t>(0), std::optional<int64_t>()}) {
      record.*count = number;
      WriteShardRecord(folder.Path(), record);
      EXPECT_EQ(
          ReadShardRecord(GetShardPath(folder.Path(), "observe", 0, 3)).*count,
          number);
    }
  }
}

TEST(ShardRecordTest, BrokenFilesAreErrorsThatNameThem) {
  const TemporaryFolder folder;
  const std::filesystem::path path =
      GetShardPath(folder.Path(), "observe", 0, 3);
  WriteShardRecord(folder.Path(), MakeRecord(0));
  const std::string text = ReadText(path);
  const size_t state = text.find("\"observed\"");
  ASSERT_NE(state, std::string::npos);
  const size_t count = text.find("\"count\": 3");
  ASSERT_NE(count, std::string::npos);
  const size_t masks = text.find("\"num_masks\": 0");
  ASSERT_NE(masks, std::string::npos);
  for (const std::string& broken :
       {text.substr(0, masks) + "\"num_masks\": []" + text.substr(masks + 14),
        text.substr(0, count) + "\"count\": 4" + text.substr(count + 10),
        std::string(),
        std::string("{}"),
        std::string("[1]"),
        text.substr(0, text.size() / 2),
        text.substr(0, state) + "\"obsolete\"" + text.substr(state + 10),
        text.substr(0, state) + "7" + text.substr(state + 10)}) {
    WriteText(path, broken);
    for (const auto& read :
         {std::function<void()>([&] { ReadShardRecord(path); }),
          std::function<void()>([&] { ListShardRecords(folder.Path()); })}) {
      ExpectError(ErrorCode::kCorrupt, {path.string(), "delete it"}, read);
    }
  }
}

TEST(ShardRecordTest, ListsAndRemovesAll) {
  const TemporaryFolder folder;
  EXPECT_TRUE(ListShardRecords(folder.Path()).empty());
  RemoveShardRecords(folder.Path());
  WriteShardRecord(folder.Path(), MakeRecord(1));
  WriteShardRecord(folder.Path(), MakeRecord(0));
  // What killed programs left.
  WriteText(GetShardFolder(folder.Path()) / "observe-2-of-3.json.tsar_tmp",
            "{");
  WriteText(folder.Path() / "stereo/tsar/shards.removed/observe-2-of-3.json",
            "{");
  const auto records = ListShardRecords(folder.Path());
  ASSERT_EQ(records.size(), 2u);
  EXPECT_EQ(records.begin()->second.index, 0);
  RemoveShardRecords(folder.Path());
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path() / "stereo/tsar"));
}

TEST(ShardRecordTest, TellsWhatDiffers) {
  const ShardRecord own = MakeRecord(0);
  const auto expect_difference =
      [&](const std::string& text,
          const std::function<void(ShardRecord*)>& change) {
        ShardRecord other = MakeRecord(1);
        RequireSameWork(own, other, "shards/x.json");
        change(&other);
        ExpectError(ErrorCode::kMismatch,
                    {"shards/x.json", text, "delete the folder shards"},
                    [&] { RequireSameWork(own, other, "shards/x.json"); });
      };
  expect_difference("one of 4, this one as one of 3",
                    [](ShardRecord* other) { other->count = 4; });
  expect_difference("version 1.3, this one by 1.2",
                    [](ShardRecord* other) { other->version = "1.3"; });
  expect_difference("photometric maps, this one on geometric",
                    [](ShardRecord* other) { other->type = "photometric"; });
  expect_difference("tau 2, this one with 1", [](ShardRecord* other) {
    other->options["tau"] = "2";
    other->options_hash = "4567";
  });
  expect_difference("tau missing", [](ShardRecord* other) {
    other->options.erase("tau");
    other->options_hash = "4567";
  });
  expect_difference("by another build of this version",
                    [](ShardRecord* other) { other->options_hash = "4567"; });
  expect_difference("patch-match.cfg",
                    [](ShardRecord* other) { other->images_hash = "78"; });
}

}  // namespace
}  // namespace tsar
