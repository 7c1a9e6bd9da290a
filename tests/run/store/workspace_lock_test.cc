// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/workspace_lock.h"

#include <csignal>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "tests/support/test_workspace.h"

namespace tsar {
namespace {

TEST(WorkspaceLockTest, RefusesASecondHolderUntilTheFirstIsGone) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.Path() / "stereo");
  const auto path = folder.Path() / "stereo/tsar/lock";
  {
    const WorkspaceLock lock(folder.Path());
    EXPECT_TRUE(std::filesystem::exists(path));
    for (int i = 0; i < 2; ++i) {
      ExpectError(ErrorCode::kUnsupported, {path.string()}, [&] {
        WorkspaceLock second(folder.Path());
      });
    }
    EXPECT_TRUE(std::filesystem::exists(path));
  }
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "stereo/tsar"));
  const WorkspaceLock again(folder.Path());
}

TEST(WorkspaceLockTest, ReadersShareItWithoutWriters) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.Path() / "stereo");
  const auto path = folder.Path() / "stereo/tsar/lock";
  {
    const WorkspaceLock first(folder.Path(), WorkspaceLock::Mode::kShared);
    { const WorkspaceLock second(folder.Path(), WorkspaceLock::Mode::kShared); }
    EXPECT_TRUE(std::filesystem::exists(path));
    ExpectError(ErrorCode::kUnsupported, {path.string()}, [&] {
      WorkspaceLock writer(folder.Path());
    });
  }
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "stereo/tsar"));
  const WorkspaceLock writer(folder.Path());
  ExpectError(ErrorCode::kUnsupported, {path.string()}, [&] {
    WorkspaceLock reader(folder.Path(), WorkspaceLock::Mode::kShared);
  });
}

TEST(WorkspaceLockTest, ReadersAndShardsComeAndGoSideBySide) {
  using Mode = WorkspaceLock::Mode;
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.Path() / "stereo");
  for (const Mode mode : {Mode::kShared, Mode::kShard}) {
    std::vector<std::jthread> programs;
    for (int i = 0; i < 4; ++i) {
      programs.emplace_back([&, i] {
        for (int j = 0; j < 300; ++j) {
          EXPECT_NO_THROW(WorkspaceLock(folder.Path(), mode, i));
        }
      });
    }
  }
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "stereo/tsar"));
  const WorkspaceLock writer(folder.Path());
}

TEST(WorkspaceLockTest, ReadersNeedNoPermissionToWrite) {
  const TemporaryFolder folder;
  WriteText(folder.Path() / "stereo/tsar", "a file");
  const WorkspaceLock reader(folder.Path(), WorkspaceLock::Mode::kShared);
  EXPECT_EQ(ReadText(folder.Path() / "stereo/tsar"), "a file");
}

TEST(WorkspaceLockTest, WritersRefuseFoldersThatAreLinksOut) {
  const TemporaryFolder folder;
  const auto root = folder.Path() / "dense";
  const auto link = root / "stereo/depth_maps/left";
  std::filesystem::create_directories(folder.Path() / "dense_2/left");
  std::filesystem::create_directories(root / "stereo/depth_maps");
  std::filesystem::create_directory_symlink(folder.Path() / "dense_2/left",
                                            link);
  ExpectError(ErrorCode::kUnsupported, {link.string(), "dense_2"}, [&] {
    WorkspaceLock lock(root);
  });
  ExpectError(ErrorCode::kUnsupported, {link.string(), "dense_2"}, [&] {
    WorkspaceLock lock(root, WorkspaceLock::Mode::kShard, 0);
  });
  EXPECT_FALSE(std::filesystem::exists(root / "stereo/tsar"));
  { const WorkspaceLock lock(root, WorkspaceLock::Mode::kShared); }
  // Links that stay inside, and those to files, are nobody else's.
  std::filesystem::remove(link);
  std::filesystem::create_directories(root / "stereo/elsewhere");
  std::filesystem::create_directory_symlink(root / "stereo/elsewhere", link);
  WriteText(folder.Path() / "map", "");
  std::filesystem::create_symlink(folder.Path() / "map",
                                  root / "stereo/depth_maps/a.bin");
  const WorkspaceLock lock(root);
}

TEST(WorkspaceLockTest, ShardsShareIt) {
  using Mode = WorkspaceLock::Mode;
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.Path() / "stereo");
  const auto expect_refusal =
      [&](const std::string& text, Mode mode, int shard = 0) {
        ExpectError(ErrorCode::kUnsupported, {"stereo/tsar", text}, [&] {
          WorkspaceLock lock(folder.Path(), mode, shard);
        });
      };
  {
    const WorkspaceLock first(folder.Path(), Mode::kShard, 0);
    {
      const WorkspaceLock second(folder.Path(), Mode::kShard, 7);
      expect_refusal("shard 7", Mode::kShard, 7);
    }
    { const WorkspaceLock again(folder.Path(), Mode::kShard, 7); }
    expect_refusal("shard 0", Mode::kShard);
    expect_refusal("another program", Mode::kExclusive);
    // None of those that were refused left anything locked.
    const WorkspaceLock third(folder.Path(), Mode::kShard, 1);
  }
  const WorkspaceLock lock(folder.Path());
  expect_refusal("another program", Mode::kShard);
}

TEST(WorkspaceLockDeathTest, AKilledShardHoldsNothing) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.Path() / "stereo");
  EXPECT_EXIT(
      {
        const WorkspaceLock lock(folder.Path(), WorkspaceLock::Mode::kShard, 3);
        std::raise(SIGKILL);
      },
      testing::KilledBySignal(SIGKILL),
      "");
  EXPECT_TRUE(std::filesystem::exists(folder.Path() / "stereo/tsar/lock"));
  { const WorkspaceLock lock(folder.Path(), WorkspaceLock::Mode::kShard, 3); }
  const WorkspaceLock whole(folder.Path());
}

TEST(WorkspaceLockTest, NeedsAWorkspace) {
  const TemporaryFolder folder;
  ExpectError(ErrorCode::kNotFound, {(folder.Path() / "stereo").string()}, [&] {
    WorkspaceLock lock(folder.Path());
  });
  EXPECT_TRUE(std::filesystem::is_empty(folder.Path()));
  WriteText(folder.Path() / "stereo/tsar", "a file");
  ExpectError(ErrorCode::kIo, {(folder.Path() / "stereo/tsar").string()}, [&] {
    WorkspaceLock lock(folder.Path());
  });
}

}  // namespace
}  // namespace tsar
